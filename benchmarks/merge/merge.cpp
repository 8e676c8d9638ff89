// Merges folders file by file; only what differs is parsed. Threads share the files.
#include "benchmarks/merge/merge.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <compare>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>

#include "benchmarks/run/process_group.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/output.h"
#include "core/records/json_view.h"
#include "core/records/record.h"
#include "core/records/request.h"
#include "core/records/sheet.h"
#include "core/seeds.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

bool is_nondeterministic(const Json& record) { return record.at("nondeterministic").get<bool>(); }

// Runs that ended by themselves come after those that a clock ended, then the latest; the text
// decides what is left, so that the order of the folders decides nothing.
auto rank_of(const Json& record) {
  Json rest = record;
  for (const char* united : {"repeat_wall_seconds", "fields", "spectrum"}) rest.erase(united);
  const Json run = record.at("provenance").value("run", Json::object());
  return std::tuple(!is_nondeterministic(record),
                    run.is_object() ? run.value("started", std::string()) : std::string(),
                    json_text(rest));
}

Json united_timings(const Json& a, const Json& b) {
  std::vector<Real> left = reals_of(a), right = reals_of(b), both;
  const auto is_less = [](Real x, Real y) { return std::strong_order(x, y) < 0; };  // nan last
  std::ranges::sort(left, is_less);
  std::ranges::sort(right, is_less);
  std::ranges::set_union(left, right, std::back_inserter(both), is_less);
  return json_numbers(both);
}

std::string shown(const Json& value) {
  constexpr std::size_t kMost = 60;
  const std::string text = json_text(value);
  return text.size() > kMost ? std::string(cut(text, kMost)) + "…" : text;
}

// "/summary/loss (1.5, 1.6), /status (…), and 3 more places".
std::string first_differences(const Json& a, const Json& b) {
  constexpr std::size_t kTold = 3;
  const Json patch = Json::diff(a, b);
  std::string text;
  for (std::size_t i = 0; i < std::min(patch.size(), kTold); ++i) {
    const Json::json_pointer place(patch[i].at("path").get<std::string>());
    const auto at = [&](const Json& json) {
      return json.contains(place) ? shown(json.at(place)) : std::string("absent");
    };
    text += fmt::format("{}{} ({}, {})", i == 0 ? "" : ", ", place.to_string(), at(a), at(b));
  }
  if (patch.size() > kTold) text += fmt::format(", and {} more places", patch.size() - kTold);
  return text;
}

}  // namespace

std::string unite_records(Json& record, const Json& other) {
  const Json left = result_of(record), right = result_of(other);
  const bool is_same = left == right;
  if (!is_same && !is_nondeterministic(record) && !is_nondeterministic(other))
    return first_differences(left, right);
  const bool is_other = rank_of(record) < rank_of(other);
  Json united = is_other ? other : record;
  for (const char* asked : {"fields", "spectrum"})  // only one of the runs may have kept them
    if (const Json& from = is_other ? record : other;
        is_same && from.contains(asked) && !united.contains(asked))
      united[asked] = from.at(asked);
  united["repeat_wall_seconds"] =
      united_timings(record.at("repeat_wall_seconds"), other.at("repeat_wall_seconds"));
  record = std::move(united);
  return "";
}

std::string answer_violation(const Json& record, const std::filesystem::path& file) {
  if (!record.contains("answer") || !record.at("answer").contains("digest")) return "";
  try {
    if (record.at("answer").at("digest") == digest(read_text(answer_path(file), kMostRecordBytes)))
      return "";
    return fmt::format("{} is not the file of the answer that the record states",
                       answer_path(file).filename().string());
  } catch (const UsageError& error) {
    return fmt::format("the file of its answer cannot be read: {}", error.what());
  }
}

std::string fields_violation(const Json& record, const std::filesystem::path& file) {
  if (!record.contains("fields")) return "";
  try {
    const Json& fields = record.at("fields");
    require_sound({.iterations = fields.at("iterations"), .shape = fields.at("shape")});
    const std::string bytes = read_text(field_path(file), kMostRecordBytes);
    if (fields.at("digest") == digest(bytes)) return "";
    return fmt::format("{} is not the file of fields that the record states",
                       field_path(file).filename().string());
  } catch (const UsageError& error) {
    return fmt::format("the file of its fields cannot be read: {}", error.what());
  }
}

namespace {

struct EndingAsked {};
void go_on() {
  if (asked_to_end() != Asked::nothing) throw EndingAsked();
}

// By cell; the least where a digest has two.
Plan plan_union(const std::vector<Plan>& plans) {
  Plan all;
  std::map<std::string, PlannedCell> cells;
  const auto key = [](const PlannedCell& cell) {
    return std::tie(cell.problem, cell.optimizer, cell.seed, cell.cell);
  };
  for (const Plan& plan : plans) {
    for (const std::string& suite : plan.suites) add_suite(all.suites, suite);
    for (const PlannedCell& cell : plan.cells) {
      const auto [at, is_first] = cells.emplace(cell.cell, cell);
      if (!is_first && key(cell) < key(at->second)) at->second = cell;
    }
  }
  std::ranges::sort(all.suites);
  for (const auto& [digest, cell] : cells) all.cells.push_back(cell);
  std::ranges::sort(all.cells, {}, key);
  return all;
}

// The rows of the tables of rates that plans used, one a problem and optimizer.
Json rates_union(const std::vector<Json>& tables) {
  std::map<std::pair<std::string, std::string>, Json> rows;
  for (const Json& table : tables)
    for (const Json& row : table.at("rows")) {
      const auto [at, is_first] = rows.try_emplace({row.at("problem"), row.at("optimizer")}, row);
      if (!is_first && json_text(row) < json_text(at->second)) at->second = row;
    }
  Json all = Json::array();
  for (const auto& [pair, row] : rows) all.push_back(row);
  return {{"schema", "isoline.rates/1"}, {"rows", all}};
}

struct Copy {
  std::string text;
  fs::path folder;
};

class Merge {
 public:
  Merge(const std::vector<fs::path>& folders, const fs::path& out, const Listener& listener)
      : folders_(folders), out_(out), listener_(listener) {}

  MergeOutcome run() {
    merge_part("runs");
    merge_part("components");
    const auto plans = read_all<Plan>("plan.json", plan_from_text);
    if (!plans.empty()) write_unflushed(out_ / "plan.json", file_text(plan_union(plans)));
    const auto rates = read_all<Json>("rates.json", [](const auto& text, const auto& origin) {
      const Json table = parse_json(text, origin);
      rates_union({table});  // refuses what is no table
      return table;
    });
    if (!rates.empty()) write_unflushed(out_ / "rates.json", json_text(rates_union(rates)) + "\n");
    merge_audits();
    std::ranges::sort(outcome_.conflicts);
    std::ranges::sort(outcome_.unreadable);
    return outcome_;
  }

 private:
  void merge_part(const std::string& part) {
    fs::create_directories(out_ / part);
    std::map<std::string, std::vector<const fs::path*>> owners;  // folders, by the file's name
    for (const fs::path& folder : folders_) try {
        std::error_code unknown;
        require(!fs::is_symlink(folder / part, unknown), [&] {
          return fmt::format("{} is a symbolic link, which merge does not follow",
                             (folder / part).string());
        });
        for (std::string& name : names_in(folder / part))
          if (!name.ends_with(".tmp")) owners[std::move(name)].push_back(&folder);
      } catch (const UsageError& error) {
        outcome_.unreadable.emplace_back(error.what());
      }
    std::vector<const decltype(owners)::value_type*> files;
    for (const auto& file : owners) files.push_back(&file);
    const auto merge_one = [&](std::size_t i) {
      go_on();
      merge_file(fs::path(part) / files[i]->first, files[i]->second);
    };
    share(files.size(), merge_one, listener_);
  }

  void merge_file(const fs::path& name, const std::vector<const fs::path*>& owners) {
    static thread_local JsonReader reader;
    const bool is_json = name.extension() == ".json";
    std::vector<Copy> copies;  // of different text
    for (const fs::path* folder : owners) try {
        std::string text = read_text(*folder / name, kMostRecordBytes, Links::refused);
        if (std::ranges::find(copies, text, &Copy::text) != copies.end()) continue;
        if (is_json) reader.parse(text, (*folder / name).string());
        copies.push_back({std::move(text), *folder});
      } catch (const UsageError& error) {
        const std::lock_guard lock(mutex_);
        outcome_.unreadable.emplace_back(error.what());
      }
    if (copies.empty()) return;
    const bool is_record = is_json && name.parent_path() == "runs";
    std::optional<std::string> text = copies[0].text;
    if (copies.size() > 1 && is_record) {
      text = united_record(name, copies);
    } else if (copies.size() > 1 && !is_json) {
      text.reset();
      dispute({"", fmt::format("{}: its copies differ in {}", name.filename().string(),
                               places(copies))});
    }
    if (!text) return;
    write_unflushed(out_ / name, *text);
    const std::lock_guard lock(mutex_);
    outcome_.records += is_record;
    outcome_.united += is_record && copies.size() > 1;
  }

  std::optional<std::string> united_record(const fs::path& file, const std::vector<Copy>& copies) {
    const std::string name = file.filename().string();
    try {
      Json record = parse_json(copies[0].text, name);
      const Request request = request_from_json(record.at("request"));
      for (std::size_t i = 1; i < copies.size(); ++i) {
        const std::string difference = unite_records(record, parse_json(copies[i].text, name));
        if (difference.empty()) continue;
        dispute({request.optimizer.name,
                 fmt::format("{} × {}, seed {} ({}): the results in {} differ at {}",
                             request.problem.spec, request.optimizer.spec, seed_text(request.seed),
                             name, places(copies), difference)});
        return std::nullopt;
      }
      return json_text(record) + "\n";
    } catch (const std::exception& error) {
      dispute({"", fmt::format("{}: its copies in {} differ and are not records: {}", name,
                               places(copies), reason_of(error))});
      return std::nullopt;
    }
  }

  // Files that each folder may have once; a damaged file is named.
  template <class Value, class Read>
  std::vector<Value> read_all(const char* name, Read read) {
    std::vector<Value> all;
    for (const fs::path& folder : folders_) {
      const fs::path file = folder / name;
      if (is_there(file)) try {
          all.push_back(read(read_text(file, kMostBytes, Links::refused), file.string()));
        } catch (const std::exception& error) {
          outcome_.unreadable.push_back(
              fmt::format("{}: {}", file.string(), reason_without(file.string(), error)));
        }
    }
    return all;
  }

  void merge_audits() {
    const auto audits = read_all<Json>("audit.json", [](const auto& text, const auto& origin) {
      return audit_to_json(audit_from_text(text, origin));
    });
    if (audits.empty()) return;
    std::map<std::string, Json> by_name;
    for (const Json& audit : audits)
      for (const Json& audited : audit.at("optimizers")) {
        const auto [known, is_new] = by_name.try_emplace(audited.at("name"), audited);
        if (!is_new && known->second != audited)
          dispute({known->first, "the audits of the folders differ"});
      }
    Json all = audit_to_json({});
    for (const auto& [name, audited] : by_name) all["optimizers"].push_back(audited);
    write_unflushed(out_ / "audit.json", json_text(all, 1) + "\n");
  }

  void dispute(Conflict conflict) {
    const std::lock_guard lock(mutex_);
    outcome_.conflicts.push_back(std::move(conflict));
  }

  static std::string places(const std::vector<Copy>& copies) {
    std::vector<std::string> names;
    for (const Copy& copy : copies) names.push_back(copy.folder.string());
    return fmt::format("{}", fmt::join(names, ", "));
  }

  const std::vector<fs::path>& folders_;
  const fs::path& out_;
  const Listener& listener_;
  std::mutex mutex_;
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
          [&] { return fmt::format("{} already exists: pass a new folder", out.string()); });
  const fs::path place = fs::weakly_canonical(out), unfinished = temporary_of(place);
  const InterruptGuard guard;  // what is half made is removed before the program ends
  try {
    make_output_folder(unfinished);
    fs::remove_all(unfinished);  // what a killed process of this number left
    fs::create_directory(unfinished);
    MergeOutcome outcome = Merge(folders, unfinished, listener).run();
    if (!outcome.conflicts.empty()) {
      fs::remove_all(unfinished);
      return outcome;
    }
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

std::string conflicts_text(const std::vector<Conflict>& conflicts) {
  constexpr std::size_t kExamples = 3;
  std::map<std::string, std::vector<std::string>> groups;
  for (const Conflict& conflict : conflicts)
    groups[conflict.optimizer].push_back(conflict.sentence);
  std::vector<std::pair<std::string, std::vector<std::string>>> sorted(groups.begin(),
                                                                       groups.end());
  std::ranges::stable_sort(sorted, std::less(), [](const auto& group) {
    return std::pair(group.first.empty(), -static_cast<std::ptrdiff_t>(group.second.size()));
  });
  std::string text;
  for (const auto& [optimizer, sentences] : sorted) {
    text += fmt::format("{}: {} conflict{}\n", optimizer.empty() ? "other files" : optimizer,
                        sentences.size(), sentences.size() == 1 ? "" : "s");
    for (std::size_t i = 0; i < std::min(kExamples, sentences.size()); ++i)
      text += "  " + sentences[i] + "\n";
    if (sentences.size() > kExamples)
      text += fmt::format("  … and {} more\n", sentences.size() - kExamples);
  }
  return text;
}

}  // namespace isoline::benchmarks
