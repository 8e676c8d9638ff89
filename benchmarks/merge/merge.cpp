// Merges folders file by file: what only one folder has, or all have alike, is copied unread but
// for its grammar; only what differs is parsed and joined. Threads share the files.
#include "benchmarks/merge/merge.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "benchmarks/merge/copies.h"
#include "benchmarks/merge/ending.h"
#include "benchmarks/merge/field_copies.h"
#include "benchmarks/merge/join.h"
#include "benchmarks/merge/merge_audits.h"
#include "core/digest.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/records/plan.h"
#include "core/records/record.h"
#include "core/threads.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

std::string title_of(const Request& request) {
  return fmt::format("{} × {}, seed {}", request.problem.spec, request.optimizer.spec,
                     request.seed);
}

Json json_from(const std::string& text, const std::string& origin) {
  return parse_json(text, origin);
}
std::string text_of(const Plan& plan) { return file_text(plan); }
std::string text_of(const Json& json) { return json_text(json) + "\n"; }

class Merge {
 public:
  Merge(const std::vector<fs::path>& folders, const fs::path& out, const Listener& listener)
      : folders_(folders), out_(out), listener_(listener) {}

  MergeOutcome run() {
    read_old_conflicts();
    merge_part("runs", [this](const std::string& name, const std::vector<Copy>& copies) {
      record(name, copies);
    });
    merge_part("components", [this](const std::string& name, const std::vector<Copy>& copies) {
      sheet(name, copies);
    });
    merge_list<Plan>("plan.json", plan_from_text, join_plans);
    merge_list<Json>("rates.json", json_from, join_rates);
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

  template <class One>
  void merge_part(const char* part, const One& one) {
    fs::create_directories(out_ / part);
    const Part files(folders_, part, outcome_.unreadable);
    const auto merge_one = [&](std::size_t i) {
      go_on();
      std::vector<std::string> damaged;
      one(files.name(i), files.copies(i, damaged));
      for (const std::string& sentence : damaged) tell(outcome_.unreadable, sentence);
    };
    share(files.size(), merge_one, listener_);
  }

  void record(const std::string& name, const std::vector<Copy>& copies) {
    if (disputed_.contains(name) || copies.empty()) return;
    const bool is_record = name.ends_with(".json");
    if (copies.size() == 1) return keep(name, copies[0].text, is_record);
    if (is_record) return join(name, copies);
    const std::string wanted = digest_of_fields(folders_, name);
    for (const Copy& copy : copies)
      if (digest(copy.text) == wanted) return keep(name, copy.text, false);
    dispute(name, {"", fmt::format("{}: its copies differ in {}", name, places(copies))});
  }

  void join(const std::string& name, const std::vector<Copy>& copies) {
    try {
      Json joined = parse_json(copies[0].text, name);
      const Request request = request_from_json(joined.at("request"));
      bool is_other = false;
      for (std::size_t i = 1; i < copies.size(); ++i) {
        const JoinedRecord both = join_records(joined, parse_json(copies[i].text, name));
        if (!both.difference.empty())
          return dispute(
              name, {request.optimizer.name,
                     fmt::format("{} ({}): the results in {} differ at {}", title_of(request), name,
                                 places(copies), both.difference)});
        is_other = is_other || both.is_provenance_other;
        joined = *both.record;
      }
      other_provenance_ += is_other;
      ++united_;
      keep(name, json_text(joined) + "\n", true);
    } catch (const std::exception& error) {
      dispute(name, {"", fmt::format("{}: its copies in {} differ and are no records: {}", name,
                                     places(copies), error.what())});
    }
  }

  // Sheets describe components and are no results: of two wordings the lesser text stays, and the
  // outcome says so.
  void sheet(const std::string& name, const std::vector<Copy>& copies) {
    if (copies.empty()) return;
    std::vector<std::string> texts;
    for (const Copy& copy : copies) texts.push_back(copy.text);
    other_sheets_ += have_other_wordings(texts);
    write_unflushed(out_ / "components" / name, texts[0]);
  }

  // A file that each folder may have, united where several have it; a damaged one is
  // named.
  template <class List>
  void merge_list(const char* name, List (*read)(const std::string&, const std::string&),
                  List (*united)(const List&, const List&)) {
    std::set<std::string> texts;
    std::optional<List> all;
    for (const fs::path& folder : folders_) {
      const fs::path file = folder / name;
      if (is_there(file)) try {
          std::string text = read_text(file, kMostBytes, Links::refused);
          const List one = read(text, file.string());
          all = united(all ? *all : one, one);
          texts.insert(std::move(text));
        } catch (const std::exception& error) {
          tell(outcome_.unreadable, fmt::format("{}: {}", file.string(), error.what()));
        }
    }
    if (all) write_unflushed(out_ / name, texts.size() == 1 ? *texts.begin() : text_of(*all));
  }

  void merge_audits() {
    AuditUnion audits = unite_audits(folders_);
    if (audits.json) write_unflushed(out_ / "audit.json", json_text(*audits.json, 1) + "\n");
    disputed_audits_ = std::move(audits.disputed);
    std::ranges::move(audits.conflicts, std::back_inserter(outcome_.conflicts));
    std::ranges::move(audits.unreadable, std::back_inserter(outcome_.unreadable));
  }

  void read_old_conflicts() {
    for (const fs::path& folder : folders_)
      for (const std::string& name : disputed_in(folder).records)
        if (disputed_.insert(name).second)
          outcome_.conflicts.push_back(
              {"", fmt::format("{}: in conflict since an earlier merge ({})", name,
                               (folder / "conflicts.json").string())});
  }

  void write_conflicts() {
    if (disputed_.empty() && disputed_audits_.empty()) return;
    Json json{{"schema", kConflictsSchema}, {"records", disputed_}};
    if (!disputed_audits_.empty()) json["audits"] = disputed_audits_;
    write_unflushed(out_ / "conflicts.json", json_text(json, 1) + "\n");
  }

  void keep(const std::string& name, const std::string& text, bool is_record) {
    write_unflushed(out_ / "runs" / name, text);
    const std::lock_guard lock(mutex_);
    outcome_.records += is_record;
  }

  void dispute(const std::string& name, Conflict conflict) {
    const std::lock_guard lock(mutex_);
    outcome_.conflicts.push_back(std::move(conflict));
    newly_disputed_.insert(name);
  }

  void tell(std::vector<std::string>& sentences, const std::string& sentence) {
    const std::lock_guard lock(mutex_);
    sentences.push_back(sentence);
  }

  std::string places(const std::vector<Copy>& copies) const {
    std::vector<std::string> names;
    for (const Copy& copy : copies) names.push_back(folders_[copy.folder].string());
    std::ranges::sort(names);
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

MergeOutcome merge_folders(const std::vector<fs::path>& given, const fs::path& out,
                           const Listener& listener) {
  const std::set<fs::path> sorted(given.begin(), given.end());  // their order decides nothing
  const std::vector<fs::path> folders(sorted.begin(), sorted.end());
  std::error_code unknown;
  for (const fs::path& folder : folders)
    require(fs::is_directory(folder, unknown),
            [&] { return fmt::format("{}: no such result folder", folder.string()); });
  require(!is_there(out) || (fs::is_directory(out, unknown) && names_in(out).empty()),
          [&] { return fmt::format("{} exists already: merge into a new folder", out.string()); });
  const fs::path place = fs::weakly_canonical(out), unfinished = temporary_of(place);
  const EndingGuard guard;
  try {
    fs::remove_all(unfinished);
    fs::create_directories(unfinished);
    MergeOutcome outcome = Merge(folders, unfinished, listener).run();
    flush_all(unfinished);
    go_on();
    fs::rename(unfinished, place);
    return outcome;
  } catch (const EndingAsked&) {
    fs::remove_all(unfinished, unknown);
    return {.is_interrupted = true};
  } catch (...) {
    fs::remove_all(unfinished, unknown);
    throw;
  }
}

}  // namespace isoline::benchmarks
