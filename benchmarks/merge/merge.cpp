// Merges folders file by file: what only one folder has, or all have alike, is copied unread but
// for its grammar; only what differs is parsed and joined. Threads share the files.
#include "benchmarks/merge/merge.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/merge/join.h"
#include "benchmarks/merge/merge_audits.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/records/record.h"
#include "core/threads.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

using Group = std::vector<fs::path>;          // the files of one name
using Groups = std::map<std::string, Group>;  // by name

Groups files_of(const std::vector<fs::path>& folders, const fs::path& part) {
  Groups groups;
  for (const fs::path& folder : folders) {
    if (!fs::is_directory(folder / part)) continue;
    for (const auto& entry : fs::directory_iterator(folder / part))
      if (entry.is_regular_file() && entry.path().extension() != ".tmp")
        groups[entry.path().filename()].push_back(entry.path());
  }
  return groups;
}

std::string title_of(const Json& record) {
  const Request request = request_from_json(record.at("request"));
  return fmt::format("{} × {}, seed {}", request.problem.spec, request.optimizer.spec,
                     request.seed);
}

class Merge {
 public:
  Merge(const std::vector<fs::path>& folders, const fs::path& out, const Listener& listener)
      : folders_(folders), out_(out), listener_(listener) {}

  MergeOutcome run() {
    read_old_conflicts();
    merge_part("runs",
               [this](const std::string& name, const Group& files) { record(name, files); });
    merge_part("components",
               [this](const std::string& name, const Group& files) { sheet(name, files); });
    merge_lists("plan.json", join_plans);
    merge_lists("rates.json", join_rates);
    merge_audits();
    remark(other_provenance_,
           "records agree but for timings and provenance; the latest run's provenance is kept");
    remark(other_sheets_, "component sheets differ between the folders; one of each is kept");
    disputed_.merge(newly_disputed_);
    write_conflicts();
    outcome_.united = united_;
    std::ranges::sort(outcome_.conflicts);
    std::ranges::sort(outcome_.unreadable);
    return outcome_;
  }

 private:
  void remark(std::size_t count, const char* what) {
    if (count > 0) outcome_.remarks.push_back(fmt::format("{} {}", count, what));
  }

  void merge_part(const char* part,
                  const std::function<void(const std::string&, const Group&)>& one) {
    fs::create_directories(out_ / part);
    const Groups groups = files_of(folders_, part);
    const std::vector<std::pair<std::string, Group>> list(groups.begin(), groups.end());
    share(
        list.size(), [&](std::size_t i) { one(list[i].first, list[i].second); }, listener_);
  }

  // The texts of a group, once each, without those that are damaged.
  std::vector<std::string> texts_of(const Group& files) {
    std::vector<std::string> texts;
    for (const fs::path& file : files) {
      std::string text = read_text(file);
      if (std::ranges::find(texts, text) != texts.end()) continue;
      if (file.extension() == ".json" && !Json::accept(text))
        tell(outcome_.unreadable, file.string() + " is no JSON");
      else
        texts.push_back(std::move(text));
    }
    return texts;
  }

  void record(const std::string& name, const Group& files) {
    if (disputed_.contains(name)) return;
    const std::vector<std::string> texts = texts_of(files);
    if (texts.empty()) return;
    const bool is_record = name.ends_with(".json");
    if (texts.size() == 1) return keep(name, texts[0], is_record);
    if (!is_record)
      return dispute(name, fmt::format("{}: its copies differ in {}", name, parents(files)));
    join(name, files, texts);
  }

  void join(const std::string& name, const Group& files, const std::vector<std::string>& texts) {
    try {
      Json joined = parse_json(texts[0], name);
      for (std::size_t i = 1; i < texts.size(); ++i) {
        const Json other = parse_json(texts[i], name);
        JoinedRecord both = join_records(joined, other);
        if (!both.difference.empty())
          return dispute(
              name, fmt::format("{} ({}): the results in {} differ at {}", title_of(joined), name,
                                parents(files), both.difference));
        other_provenance_ += i == 1 && both.is_provenance_other;
        joined = *both.record;
      }
      ++united_;
      keep(name, joined.dump() + "\n", true);
    } catch (const std::exception& error) {
      dispute(name, fmt::format("{}: its copies in {} differ and are no records: {}", name,
                                parents(files), error.what()));
    }
  }

  // Sheets describe components and are no results: of two wordings the lesser text stays, and the
  // outcome says so.
  void sheet(const std::string& name, const Group& files) {
    const std::vector<std::string> texts = texts_of(files);
    if (texts.empty()) return;
    other_sheets_ += have_other_wordings(texts);
    write_unflushed(out_ / "components" / name, *std::ranges::min_element(texts));
  }

  // A file that each folder may have, united by `join` where several have it.
  void merge_lists(const char* name, Json (*join)(const Json&, const Json&)) {
    Group files;
    for (const fs::path& folder : folders_)
      if (const fs::path file = folder / name; fs::exists(file)) files.push_back(file);
    const std::vector<std::string> texts = texts_of(files);
    if (texts.empty()) return;
    if (texts.size() == 1) return write_unflushed(out_ / name, texts[0]);
    Json all = parse_json(texts[0], name);
    for (const std::string& text : texts) all = join(all, parse_json(text, name));
    write_unflushed(out_ / name, all.dump() + "\n");
  }

  void merge_audits() {
    AuditUnion audits = unite_audits(folders_);
    if (audits.json) write_unflushed(out_ / "audit.json", audits.json->dump(1) + "\n");
    disputed_audits_ = std::move(audits.disputed);
    std::ranges::move(audits.conflicts, std::back_inserter(outcome_.conflicts));
    std::ranges::move(audits.unreadable, std::back_inserter(outcome_.unreadable));
  }

  void read_old_conflicts() {
    for (const fs::path& folder : folders_) {
      if (!fs::exists(folder / "conflicts.json")) continue;
      const Json earlier = read_json(folder / "conflicts.json");
      for (const Json& name : earlier.at("records"))
        if (disputed_.insert(name.get<std::string>()).second)
          outcome_.conflicts.push_back(fmt::format("{}: in conflict since an earlier merge ({})",
                                                   name.get<std::string>(),
                                                   (folder / "conflicts.json").string()));
    }
  }

  void write_conflicts() {
    if (disputed_.empty() && disputed_audits_.empty()) return;
    Json json{{"schema", kConflictsSchema}, {"records", disputed_}};
    if (!disputed_audits_.empty()) json["audits"] = disputed_audits_;
    write_unflushed(out_ / "conflicts.json", json.dump(1) + "\n");
  }

  void keep(const std::string& name, const std::string& text, bool is_record) {
    write_unflushed(out_ / "runs" / name, text);
    const std::lock_guard lock(mutex_);
    outcome_.records += is_record;
  }

  void dispute(const std::string& name, const std::string& sentence) {
    tell(outcome_.conflicts, sentence);
    const std::lock_guard lock(mutex_);
    newly_disputed_.insert(name);
  }

  void tell(std::vector<std::string>& sentences, const std::string& sentence) {
    const std::lock_guard lock(mutex_);
    sentences.push_back(sentence);
  }

  static std::string parents(const Group& files) {
    std::vector<std::string> names;
    for (const fs::path& file : files) names.push_back(file.parent_path().parent_path().string());
    return fmt::format("{}", fmt::join(names, ", "));
  }

  const std::vector<fs::path>& folders_;
  fs::path out_;
  const Listener& listener_;
  std::mutex mutex_;
  std::set<std::string> disputed_;         // by the folders; threads only read it
  std::set<std::string> newly_disputed_;   // by this merge
  std::set<std::string> disputed_audits_;  // optimizers
  std::atomic<std::size_t> united_{0}, other_provenance_{0}, other_sheets_{0};
  MergeOutcome outcome_;
};

}  // namespace

MergeOutcome merge_folders(const std::vector<fs::path>& folders, const fs::path& out,
                           const Listener& listener) {
  for (const fs::path& folder : folders)
    require(fs::is_directory(folder),
            [&] { return fmt::format("no result folder {}", folder.string()); });
  require(!fs::exists(out) || (fs::is_directory(out) && fs::is_empty(out)),
          [&] { return fmt::format("{} exists already: merge into a new folder", out.string()); });
  const fs::path place = fs::weakly_canonical(out);
  const fs::path unfinished = place.string() + fmt::format(".{}.tmp", ::getpid());
  try {
    fs::create_directories(unfinished);
    MergeOutcome outcome = Merge(folders, unfinished, listener).run();
    flush_all(unfinished);
    fs::rename(unfinished, place);
    return outcome;
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(unfinished, ignored);
    throw;
  }
}

}  // namespace isoline::benchmarks
