// Unpacks by the manifest, which stands first: no more is written than it tells of, and no more
// than there is room for.
#include "benchmarks/archive/unpack.h"

#include <fmt/format.h>

#include <fstream>
#include <map>

#include "core/errors.h"
#include "core/records/manifest.h"
#include "core/sha256.h"
#include "core/tar_file.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostManifest = std::size_t{1} << 29;  // of some million files

class Unpacking {
 public:
  Unpacking(const fs::path& archive, const fs::path& folder)
      : origin_(archive.string()), folder_(folder), tar_(archive) {}

  void run() {
    read_manifest();
    require_room();
    while (const auto entry = tar_.next()) write(*entry);
    for (const auto& [name, file] : files_)
      require(file.is_written, [&] { return told(name, "is missing"); });
  }

 private:
  struct Expected {
    ArchivedFile file;
    bool is_written = false;
  };

  std::string told(const std::string& name, const char* what) const {
    return fmt::format("{}: {} {}", origin_, name, what);
  }

  void read_manifest() {
    const auto entry = tar_.next();
    require(entry && entry->name == kManifestName && entry->is_file, [&] {
      return fmt::format("{} is no archive of results: it does not begin with {}", origin_,
                         kManifestName);
    });
    std::string text;
    for (std::string_view more = tar_.more(); !more.empty(); more = tar_.more()) {
      text += more;
      require(text.size() <= kMostManifest, [&] { return told(kManifestName, "is too large"); });
    }
    const Manifest manifest = manifest_from_text(text, origin_ + ": " + kManifestName);
    for (const ArchivedFile& file : manifest.files) files_[file.name].file = file;
  }

  // Before anything is written: a small file may tell of terabytes, and be true.
  void require_room() const {
    constexpr std::int64_t kMost = std::int64_t{1} << 40;
    std::int64_t bytes = 0;
    for (const auto& [name, expected] : files_) {
      require(expected.file.bytes <= kMost - bytes,
              [&] { return fmt::format("{}: it would unpack to more than a terabyte", origin_); });
      bytes += expected.file.bytes;
    }
    std::error_code unknown;
    const fs::space_info space = fs::space(folder_, unknown);
    require(unknown || static_cast<std::uintmax_t>(bytes) < space.available, [&] {
      return fmt::format("{} would unpack to {} bytes, and {} has room for {}", origin_, bytes,
                         folder_.parent_path().string(), space.available);
    });
  }

  void write(const TarEntry& entry) {
    require(entry.is_file, [&] { return told(entry.name, "is no plain file"); });
    const auto at = files_.find(entry.name);
    require(at != files_.end(), [&] { return told(entry.name, "does not stand in its manifest"); });
    Expected& expected = at->second;
    require(!expected.is_written, [&] { return told(entry.name, "is there twice"); });
    expected.is_written = true;
    const fs::path path = folder_ / entry.name;
    std::error_code in_the_way;  // a file where a folder should be: then the next line fails
    fs::create_directories(path.parent_path(), in_the_way);
    std::ofstream out(path, std::ios::binary);
    Sha256 digest;
    std::int64_t left = expected.file.bytes;
    for (std::string_view more = tar_.more(); !more.empty(); more = tar_.more()) {
      left -= static_cast<std::int64_t>(more.size());
      require(left >= 0, [&] { return told(entry.name, "is longer than its manifest says"); });
      digest.add(more);
      out.write(more.data(), static_cast<std::streamsize>(more.size()));
    }
    require(left == 0 && digest.text() == expected.file.sha256,
            [&] { return told(entry.name, "is not what its manifest says: its digest differs"); });
    out.close();
    require(out.good(), [&] { return told(entry.name, "cannot be unpacked"); });
  }

  std::string origin_;
  const fs::path& folder_;
  TarReader tar_;
  std::map<std::string, Expected> files_;
};

}  // namespace

bool is_archive(const fs::path& path) {
  const std::string name = path.filename();
  std::error_code unknown;
  return (name.ends_with(".tar.gz") || name.ends_with(".tgz")) && !fs::is_directory(path, unknown);
}

UnpackedArchive::UnpackedArchive(const fs::path& archive) {
  Unpacking(archive, folder_.path()).run();
}

}  // namespace isoline::benchmarks
