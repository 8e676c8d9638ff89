// Packs twice over the files: once for their digests, which stand first, once for their texts.
#include "benchmarks/archive/pack.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "core/errors.h"
#include "core/files.h"
#include "core/records/manifest.h"
#include "core/records/record.h"
#include "core/sha256.h"
#include "core/tar_file.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

constexpr std::array kFiles = {"audit.json", "conflicts.json", "plan.json", "predicted.json",
                               "rates.json"};
constexpr std::array kFolders = {"components", "report", "runs"};

bool is_record(const std::string& name) {
  return name.starts_with("runs/") && name.ends_with(".json");
}

// The names below a result folder of what belongs to its results, sorted as texts.
class Contents {
 public:
  explicit Contents(const fs::path& folder) : folder_(folder) {
    for (const char* name : kFiles) add(name);
    for (const char* name : kFolders) add(name);
    std::ranges::sort(names_);
    std::ranges::sort(left_out_);
  }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<std::string>& left_out() const { return left_out_; }

 private:
  // No link is followed: an archive holds what its folder holds.
  void add(const std::string& name) {
    std::error_code unknown;
    const fs::file_status status = fs::symlink_status(folder_ / name, unknown);
    if (!fs::exists(status) || name.ends_with(".tmp")) return;
    if (fs::is_directory(status))
      for (const std::string& inside : names_in(folder_ / name))
        add((fs::path(name) / inside).string());
    else
      (fs::is_regular_file(status) ? names_ : left_out_).push_back(name);
  }

  const fs::path& folder_;
  std::vector<std::string> names_, left_out_;
};

// What the manifest says of a file; of a record its program's commit, else nothing.
struct Described {
  ArchivedFile file;
  std::string commit;
};

// A damaged record travels too, as it is: whoever reads the archive is told of it as in the folder.
std::string commit_of(const std::string& text, const std::string& name) {
  try {
    const Record record = record_from_text(text, name);
    return record.imported ? "" : record.provenance.build->commit;
  } catch (const UsageError&) {
    return "";
  }
}

Described described(const fs::path& folder, const std::string& name) {
  const std::string text = read_text(folder / name, kMostBytes, Links::refused);
  return {{name, static_cast<std::int64_t>(text.size()), sha256(text)},
          is_record(name) ? commit_of(text, name) : ""};
}

Manifest manifest_of(const fs::path& folder, const std::vector<std::string>& names,
                     const Listener& listener) {
  std::vector<Described> all(names.size());
  share(
      names.size(), [&](std::size_t i) { all[i] = described(folder, names[i]); }, listener);
  Manifest manifest;
  std::set<std::string> commits;
  for (Described& one : all) {
    manifest.records += is_record(one.file.name);
    if (!one.commit.empty()) commits.insert(std::move(one.commit));
    manifest.files.push_back(std::move(one.file));
  }
  manifest.commits.assign(commits.begin(), commits.end());
  return manifest;
}

void write_archive(const fs::path& folder, const Manifest& manifest, const fs::path& out) {
  TarWriter tar(out);
  tar.add(kManifestName, file_text(manifest));
  for (const ArchivedFile& file : manifest.files) {
    const std::string text = read_text(folder / file.name, kMostBytes, Links::refused);
    require(sha256(text) == file.sha256, [&] {
      return fmt::format("{} changed while it was archived: wait until its run is done",
                         (folder / file.name).string());
    });
    tar.add(file.name, text);
  }
  tar.close();
}

}  // namespace

Packed pack_results(const fs::path& folder, const fs::path& out, const Listener& listener) {
  std::error_code unknown;
  require(fs::is_directory(folder, unknown),
          [&] { return fmt::format("{}: no such result folder", folder.string()); });
  const Contents contents(folder);
  require(std::ranges::any_of(contents.names(), is_record), [&] {
    return fmt::format("no records in {}: `isoline run --out FOLDER` writes them", folder.string());
  });
  const Manifest manifest = manifest_of(folder, contents.names(), listener);
  const fs::path unfinished = temporary_of(out);
  try {
    write_archive(folder, manifest, unfinished);
    fs::rename(unfinished, out);
  } catch (...) {
    fs::remove(unfinished, unknown);
    throw;
  }
  return {static_cast<std::size_t>(manifest.records), manifest.files.size(), contents.left_out()};
}

}  // namespace isoline::benchmarks
