// Reads result folders, and computes the work to each target.
#include "core/results/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "core/errors.h"
#include "core/files.h"
#include "core/records/fields.h"
#include "core/records/json_view.h"
#include "core/results/statistics.h"
#include "core/seeds.h"

namespace isoline::results {

void fields(Like<TunedRate> auto& rate, auto& field) {
  field("problem", rate.problem);
  field("optimizer", rate.optimizer);
  field.optional("setting", rate.setting);
  field.optional("file", rate.file);
  std::map<std::string, std::vector<Real>> grid;
  std::vector<std::vector<Real>> scores;
  field.group("source", [&](auto& source) {
    source.optional("paper", rate.paper);
    source.optional("grid", grid);
    source.optional("score", scores);
    source.optional("edge", rate.is_at_edge);
    source.optional("families", rate.families);
    source.optional("mean_score", rate.mean_scores);
    source.optional("default", rate.standard);
    source.optional("value", rate.value);
    source.optional("spent", rate.spent);
  });
  if (grid.empty()) return;
  std::tie(rate.option, rate.values) = *grid.begin();
  for (const std::vector<Real>& score : scores) rate.work.push_back(score.at(0));
  require(rate.work.empty() || rate.work.size() == rate.values.size(),
          "a grid of rates lacks the score of a value");
}

namespace {

struct RatesFile {
  std::vector<TunedRate> rows;
};
void fields(Like<RatesFile> auto& file, auto& field) { field("rows", file.rows); }

}  // namespace

bool TunedRate::is_ever_solved() const {
  return std::ranges::any_of(work, [](Real each) { return each < kNever; }) ||
         std::ranges::any_of(mean_scores, [](Real each) { return each > 0; });
}

Real TunedRate::work_of(Real tried) const {
  const auto at = std::ranges::find(values, tried);
  const auto place = static_cast<std::size_t>(at - values.begin());
  return place < work.size() ? work[place] : kNever;
}

std::vector<TunedRate> rates_from_text(const std::string& text, const std::string& origin) {
  return from_text<RatesFile>(text, origin, "not a table of rates").rows;
}

// Reads result folders. Records come by the ten thousand, and parsing them is nearly all the time a
// report takes, so threads share the files.

namespace {

namespace fs = std::filesystem;

// Empty where the file is sound, or is not there. The record counts without it.
std::string damage_of_fields(const Record& record, const fs::path& file) {
  if (record.fields && is_there(file)) try {
      FieldFrames frames = *record.fields;
      read_field_numbers(frames, file);
    } catch (const std::exception& error) {
      return reason_without(file.string(), error);
    }
  return "";
}

void read_runs(Study& study, const std::vector<std::string>& folders, const Listener& listener,
               const Trim& trim) {
  const std::vector<std::string> files = record_files(folders, study.unreadable);
  std::vector<std::string> reasons(files.size()), reasons_of_fields(files.size());
  std::vector<Record> runs(files.size());
  const auto read = [&](std::size_t i) {
    try {
      runs[i] = read_record(files[i]);
      reasons_of_fields[i] = damage_of_fields(runs[i], field_path(files[i]));
      if (trim) trim(runs[i]);
    } catch (const std::exception& error) {
      reasons[i] = reason_without(files[i], error);
    }
  };
  share(files.size(), read, listener);
  for (std::size_t i = 0; i < files.size(); ++i)
    if (!reasons_of_fields[i].empty())
      study.unreadable.push_back({field_path(files[i]), std::move(reasons_of_fields[i])});
  std::vector<RunMark> marks(files.size());
  for (std::size_t i = 0; i < files.size(); ++i)
    if (reasons[i].empty())
      marks[i] = mark_of(runs[i]);
    else
      study.unreadable.push_back({files[i], std::move(reasons[i])});
  Newest newest = newest_of(marks, [&](std::size_t i, std::size_t j) {
    return trim ? are_at_odds(read_record(files[i]), read_record(files[j]))
                : are_at_odds(runs[i], runs[j]);
  });
  // In place, since two lists of records take twice the memory.
  for (std::size_t k = 0; k < newest.kept.size(); ++k) {
    std::size_t from = newest.kept[k];
    while (from < k) from = newest.kept[from];  // where an earlier exchange has put it
    if (from != k) std::swap(runs[k], runs[from]);
  }
  runs.resize(newest.kept.size());
  study.runs = std::move(runs);
  study.superseded = newest.superseded;
  study.disputed = std::move(newest.disputed);
}

// use(text, name) of a file that may be missing; where it is damaged it is listed.
template <class Use>
void read_file(Study& study, const fs::path& file, Use use) {
  if (is_there(file)) try {
      use(read_text(file), file.string());
    } catch (const std::exception& error) {
      study.unreadable.push_back({file, reason_without(file.string(), error)});
    }
}

std::vector<std::string> json_files(const fs::path& folder, std::vector<Unreadable>& unreadable) {
  std::vector<std::string> files;
  try {
    for (const std::string& name : names_in(folder))
      if (name.ends_with(".json")) files.push_back((folder / name).string());
  } catch (const UsageError& error) {
    unreadable.push_back({folder.string(), error.what()});
  }
  return files;
}

// Plan, sheets, audit and rates of a folder; `known` has the cells and the sheets of those before.
void read_rest(Study& study, const fs::path& folder, std::set<std::string>& known) {
  std::vector<std::string> suites;
  read_file(study, folder / "plan.json", [&](const auto& text, const auto& name) {
    Plan plan = plan_from_text(text, name);
    suites.insert(suites.end(), plan.suites.begin(), plan.suites.end());
    for (PlannedCell& cell : plan.cells)
      if (known.insert(cell.cell).second) study.plan.cells.push_back(std::move(cell));
  });
  for (const std::string& file : json_files(folder / "components", study.unreadable))
    read_file(study, file, [&](const auto& text, const auto& name) {
      Sheet sheet = sheet_from_text(text, name);
      if (known.insert(sheet.file_name()).second) study.sheets.push_back(std::move(sheet));
    });
  read_file(study, folder / "audit.json", [&](const auto& text, const auto& name) {
    for (AuditedOptimizer& audited : audit_from_text(text, name))
      if (std::ranges::find(study.audits, audited.name, &AuditedOptimizer::name) ==
          study.audits.end())
        study.audits.push_back(std::move(audited));
  });
  read_file(study, folder / "rates.json", [&](const auto& text, const auto& name) {
    for (TunedRate& rate : rates_from_text(text, name)) study.rates.push_back(std::move(rate));
  });
  read_file(study, folder / "profile.json", [&](const auto& text, const auto& name) {
    for (ProfiledCell& cell : profiles_from_text(text, name))
      study.profiles.push_back(std::move(cell));
  });
  for (const std::string& suite : suites) add_suite(study.plan.suites, suite);
}

// ISO times sort as text; the file name decides where they are absent or equal.
bool is_newer(const RunMark& a, const RunMark& b) {
  return std::pair(a.started, record_file_name(a.cell, a.build)) >
         std::pair(b.started, record_file_name(b.cell, b.build));
}

// Everything that no clock decides is equal in all records of one build.
bool should_agree(const RunMark& a, const RunMark& b) {
  return a.build == b.build && !a.is_nondeterministic && !b.is_nondeterministic;
}

// "1e-4", "1.6e-4": two digits tell a rung from its neighbours.
std::string rung_name(std::size_t j) {
  if (j == 0) return "1";
  std::string text = fmt::format("{:.1e}", rung(j));
  if (const std::size_t zero = text.find(".0"); zero != std::string::npos) text.erase(zero, 2);
  if (const std::size_t zero = text.find("e-0"); zero != std::string::npos) text.erase(zero + 2, 1);
  return text;
}

Tolerance tolerance_of_rung(std::size_t j) {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (std::size_t each = 0; each < kRungs; ++each) all.push_back(rung_name(each));
    return all;
  }();
  return {names[j], rung(j), j};
}

const std::vector<std::int64_t>* column_of(const Columns& columns, std::size_t kind) {
  const auto at = columns.find(std::string(kOracleNames[kind]));
  return at == columns.end() ? nullptr : &at->second;
}

std::vector<Reached> from_hits(const Record& record, const Hits& hits, const Prices& prices) {
  const std::vector<Real> costs = prices.hit_costs(record, hits);
  std::vector<Reached> met;
  for (std::size_t j = 0; j < hits.iteration.size() && hits.iteration[j] >= 0; ++j)
    met.push_back({Real(hits.work[j]), costs[j], hits.wall_seconds[j],
                   static_cast<std::int32_t>(hits.iteration[j])});
  return met;
}

// At the first kept points where left[i] ≤ goal(j).
template <class Goal>
std::vector<Reached> from_curve(const Record& record, const Prices& prices,
                                const std::vector<Real>& left, Goal goal) {
  const Curve& curve = record.curve;
  const std::vector<Real> costs = prices.curve_costs(record);
  std::vector<Reached> met;
  std::size_t i = 0;
  for (std::size_t j = 0; j < kTargets; ++j) {
    while (i < left.size() && !(left[i] <= goal(j))) ++i;
    if (i == left.size()) break;
    met.push_back({Real(curve.work[i]), costs[i], curve.wall_seconds[i],
                   static_cast<std::int32_t>(curve.iteration[i]),
                   i > 0 && curve.iteration[i] > curve.iteration[i - 1] + 1});
  }
  return met;
}

}  // namespace

std::optional<FieldFrames> Study::fields_of(const Record& record) const {
  if (!record.fields) return std::nullopt;
  FieldFrames frames = *record.fields;
  for (const fs::path folder : folders) {
    const fs::path file = field_path(folder / "runs" / record.file_name());
    if (is_there(file)) try {
        read_field_numbers(frames, file);
        return frames;
      } catch (const std::exception&) {
        continue;  // another folder may have it whole
      }
  }
  return std::nullopt;
}

Study read_study(const std::vector<std::string>& folders, const Listener& listener,
                 const Trim& trim) {
  std::error_code unknown;
  for (const fs::path folder : folders) {
    require(!fs::is_regular_file(folder, unknown), [&] {
      return folder.string() +
             " is a file and not a result folder; if it is an archive, unpack it with tar -xf";
    });
    require(fs::is_directory(folder, unknown), [&] {
      return folder.string() + ": no such result folder; `isoline run --out FOLDER` creates one";
    });
  }
  Study study;
  study.folders = folders;
  std::set<std::string> known;
  for (const fs::path folder : folders) read_rest(study, folder, known);
  std::ranges::sort(study.audits, {}, &AuditedOptimizer::name);
  read_runs(study, folders, listener, trim);
  return study;
}

// Chooses among the records of each cell.

RunMark mark_of(const Record& record) {
  return {.cell = record.cell,
          .build = record.build,
          .started = record.provenance.run.started,
          .problem = record.request.problem.spec,
          .optimizer = record.request.optimizer.spec,
          .seed = record.request.seed,
          .is_nondeterministic = record.is_nondeterministic};
}

Newest newest_of(const std::vector<RunMark>& marks,
                 const std::function<bool(std::size_t, std::size_t)>& are_at_odds) {
  Newest newest;
  std::unordered_map<std::string_view, std::size_t> known;  // by cell, its newest so far
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks[i].cell.empty()) continue;
    const auto [at, is_first] = known.emplace(marks[i].cell, i);
    if (is_first) continue;
    ++newest.superseded;
    if (should_agree(marks[i], marks[at->second]) && are_at_odds(i, at->second))
      newest.disputed.insert(marks[i].cell);
    if (is_newer(marks[i], marks[at->second])) at->second = i;
  }
  for (const auto& [cell, i] : known) newest.kept.push_back(i);
  std::ranges::sort(newest.kept, {}, [&](std::size_t i) {
    return std::tie(marks[i].problem, marks[i].optimizer, marks[i].seed, marks[i].cell);
  });
  return newest;
}

bool are_at_odds(const Record& a, const Record& b) {
  return result_of(to_json(a)) != result_of(to_json(b));
}

std::vector<std::string> record_files(const std::vector<std::string>& folders,
                                      std::vector<Unreadable>& unreadable) {
  std::vector<std::string> all;
  for (const std::filesystem::path folder : folders)
    for (std::string& file : json_files(folder / "runs", unreadable))
      all.push_back(std::move(file));
  return all;
}

// The effort to each target: read off the hits of a record, or else off its curve, at its prices.

std::optional<Measure> measure_of(std::string_view name) {
  return choice_named<Measure>(name, kMeasureNames);
}

Tolerance tolerance_at(Real tau) { return tolerance_of_rung(rung_of(tau)); }

// The usual looser ones stay where they are looser; else a third and two thirds of the way down.
Yardstick yardstick_at(Measure by, Real tau) {
  Yardstick yardstick{.by = by};
  const Tolerance last = tolerance_at(tau);
  const bool is_usual = kTolerances[kTightest - 1].rung < last.rung;
  for (std::size_t t = 0; t < kTightest && !is_usual; ++t)
    yardstick.tolerances[t] = tolerance_of_rung((t + 1) * last.rung / kTolerances.size());
  yardstick.tolerances[kTightest] = last;
  return yardstick;
}

// Raw counts times prices.

bool is_told(const MeasuredPrices& prices, const MeasuredPrice& price) {
  const Real unit = prices.forward_seconds;
  return price.resolved && unit >= kShortestCall && price.price * unit >= kShortestCall;
}

Prices::Prices(const Sheet* sheet) {
  if (sheet == nullptr || !sheet->prices) return;
  forward_seconds_ = sheet->prices->forward_seconds;
  for (const MeasuredPrice& each : sheet->prices->oracles)
    if (each.oracle != kInference && is_told(*sheet->prices, each))
      measured_[each.oracle] = each.price;
}

Real Prices::price(const Record& record, std::size_t kind) const {
  const auto at = measured_.find(kOracleNames[kind]);
  return at == measured_.end() ? Real(record.prices[kind]) : at->second;
}

Real Prices::cost(const Record& record) const {
  if (!are_measured()) return Real(record.summary.work);
  Real sum = 0;
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    sum += price(record, kind) * Real(record.counts[kind]);
  return sum;
}

std::optional<Real> Prices::seconds(const Record& record) const {
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (record.counts[kind] > 0 && kOracleNames[kind] != "forward" &&
        !is_measured(kOracleNames[kind]))
      return std::nullopt;
  if (forward_seconds_ < kShortestCall) return std::nullopt;
  return forward_seconds_ * cost(record);
}

std::vector<Real> Prices::costs_of(const Record& record, const Columns& counts,
                                   const std::vector<std::int64_t>& work) const {
  if (!are_measured() || counts.empty()) return {work.begin(), work.end()};
  std::vector<Real> costs(work.size(), 0);
  for (std::size_t kind = 0; kind < kOracles; ++kind) {
    const auto* column = column_of(counts, kind);
    const Real each = price(record, kind);
    for (std::size_t i = 0; column != nullptr && i < std::min(costs.size(), column->size()); ++i)
      costs[i] += each * Real((*column)[i]);
  }
  return costs;
}

std::vector<Real> Prices::curve_costs(const Record& record) const {
  return costs_of(record, record.curve.counts, record.curve.work);
}

std::vector<Real> Prices::hit_costs(const Record& record, const Hits& hits) const {
  std::vector<Real> costs = costs_of(record, hits.counts, hits.work);
  for (std::size_t j = 0; j < costs.size(); ++j)
    if (hits.iteration[j] < 0) costs[j] = kNever;
  return costs;
}

namespace {

// The columns that have it, of hits or else of the curve, and the place in them.
struct WorkPlace {
  const Columns& counts;
  const Columns& rounds;
  std::size_t at;
};
WorkPlace place_at(const Record& record, Real work) {
  const auto place_in = [&](const auto& columns) {
    const auto at =
        std::ranges::find_if(columns.work, [&](std::int64_t each) { return Real(each) >= work; });
    return WorkPlace{columns.counts, columns.rounds, std::size_t(at - columns.work.begin())};
  };
  const auto is_hit = [&](std::int64_t each) { return Real(each) == work; };
  for (const std::optional<Hits>* hits : {&record.hits, &record.x_hits})
    if (*hits && !(*hits)->counts.empty() && std::ranges::any_of((*hits)->work, is_hit))
      return place_in(**hits);
  return place_in(record.curve);
}

}  // namespace

OracleCounts counts_at(const Record& record, Real work) {
  OracleCounts counts{};
  const WorkPlace place = place_at(record, work);
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (const auto* column = column_of(place.counts, kind); column && place.at < column->size())
      counts[kind] = (*column)[place.at];
  return counts;
}

Real rounds_at(const Record& record, Real work, std::int64_t workers) {
  const WorkPlace place = place_at(record, work);
  const auto column = place.rounds.find(std::to_string(workers));
  return column != place.rounds.end() && place.at < column->second.size()
             ? Real(column->second[place.at])
             : work;
}

BestKnown::BestKnown(const Study& study) {
  for (const Record& record : study.runs) {
    if (record.imported) continue;  // imported values change no other run's targets
    const auto key = std::pair(record.request.problem.spec, instance_of(record.request.seed));
    Real& least = least_.emplace(key, kNever).first->second;
    // A printed digit may lower the loss of a point that no run returned.
    const Real best = is_of_own_problem(record) ? record.summary.loss : record.summary.best_loss;
    if (record.status != Status::inapplicable && best < least) least = best;
  }
}

Real BestKnown::minimum(const Record& record) const {
  if (record.minimum) return *record.minimum;
  const auto found = least_.find({record.request.problem.spec, instance_of(record.request.seed)});
  if (found != least_.end()) return found->second;
  return record.imported ? record.summary.best_loss : std::nan("");
}

Real Reached::by(Measure measure) const {
  return std::array{work, cost, Real(iteration), seconds}[static_cast<std::size_t>(measure)];
}

std::vector<Reached> targets_met(const Record& record, const Prices& prices, Aim aim,
                                 const BestKnown& best) {
  if (record.status == Status::inapplicable) return {};
  if (aim == Aim::x) {
    if (!record.x_scale) return {};
    if (record.x_hits) return from_hits(record, *record.x_hits, prices);
    return from_curve(record, prices, record.curve.x_error, [&](std::size_t j) {
      return x_goal(rung(j), *record.x_scale, record.x_floor);
    });
  }
  if (!record.minimum && !is_of_own_problem(record)) return {};
  if (record.hits) return from_hits(record, *record.hits, prices);
  const Real minimum = best.minimum(record), scale = best.scale(record);
  return from_curve(record, prices, record.curve.loss,
                    [&](std::size_t j) { return minimum + rung(j) * scale; });
}

}  // namespace isoline::results
