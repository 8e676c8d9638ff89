// What the scripts of the page choose from, as compact JSON: names, standings to every target by
// every measure, and of each problem the medians of its cells.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <ranges>
#include <set>
#include <span>
#include <string_view>
#include <unordered_map>

#include "core/json.h"
#include "core/oracle.h"
#include "core/seeds.h"
#include "core/threads.h"
#include "core/trace.h"
#include "reports/page/page.h"
#include "reports/sections/answers.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::string_view embedded_guide();

namespace {

std::string number(Real value) { return std::isfinite(value) ? figure(value) : "null"; }

template <class Indices>
std::string indices(const Indices& all) {
  return json_list(all, [](std::size_t index) { return std::to_string(index); });
}

// −k stands for k more of the number before it; no number here is negative.
std::string repeats_json(const std::vector<std::string>& numbers) {
  std::vector<std::string> shown;
  std::size_t repeats = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    repeats = i > 0 && numbers[i] == numbers[i - 1] ? repeats + 1 : 0;
    if (repeats > 1) shown.pop_back();
    shown.push_back(repeats > 0 ? fmt::format("-{}", repeats) : numbers[i]);
  }
  return "[" + joined(shown, ",") + "]";
}

// Medians to targets by each measure as they are printed, costs with a digit more: 0 where all are
// those of the first measure.
std::string medians_json(const Comparison& c, const Cell& cell) {
  const std::vector<std::size_t> targets = targets_of(c);
  const auto medians = [&](Measure by) {
    std::vector<Real> taken;
    for (const std::size_t target : targets)
      if (const Real median = cell.median(by, target); median < kNever) taken.push_back(median);
    return taken;
  };
  const std::vector<Measure> measures = measures_of(c);
  return json_list(measures, [&](Measure by) {
    if (by != measures[0] && medians(by) == medians(measures[0])) return std::string("0");
    std::vector<std::string> texts;
    for (const Real median : medians(by))
      texts.push_back(by == Measure::time   ? milliseconds(median)
                      : by == Measure::cost ? fmt::format("{:.5g}", median)
                                            : fmt::format("{:.12g}", median));
    return repeats_json(texts);
  });
}

// The x of the first of those runs that keeps one: {"seed", "loss", "norm", "unknowns", "file",
// "columns": [[name, text of each of the first unknowns]]}; null where there is none. Beyond 1,000
// unknowns, the numbers are in the file.
std::string answer_json(const Comparison& c, std::span<const std::size_t> runs) {
  constexpr std::size_t kMost = 20;
  const auto kept = std::ranges::find_if(
      runs, [&](std::size_t run) { return c.runs[run].record->answer.has_value(); });
  if (kept == runs.end()) return "null";
  const Record& record = *c.runs[*kept].record;
  const AnswerPoints& answer = *record.answer;
  Json json = {{"seed", record.request.seed},
               {"loss", figure(answer.point(kBest).empty() ? record.summary.loss
                                                           : record.summary.best_loss)},
               {"unknowns", answer.unknowns},
               {"file", answer.is_in_file() ? answer_path(record.file_name()).string() : ""},
               {"columns", Json::array()}};
  if (answer.residual_norm) json["norm"] = figure(*answer.residual_norm);
  if (!answer.is_in_file())
    for (AnswerColumn& column : answer_columns(record, answer, "{:.8g}")) {
      column.texts.resize(std::min(kMost, column.texts.size()));
      column.texts.insert(column.texts.begin(), column.name);
      json["columns"].push_back(column.texts);
    }
  return json_text(json);
}

// The command that repeats a cell: all its seeds where these follow each other and were asked for
// alike, else the first.
std::string cell_command(const Comparison& c, const Cell& cell) {
  const Request& first = c.runs[cell.runs.front()].record->request;
  std::string command = rerun_command(first);
  std::uint64_t next = first.seed;
  for (const std::size_t run : cell.runs) {
    const Request& request = c.runs[run].record->request;
    if (request.seed != next++ || is_pair(request.seed) ||
        request.optimizer.spec != first.optimizer.spec ||
        budget_options(request) != budget_options(first))
      return command;
  }
  const std::string one = fmt::format("--seeds ={} ", first.seed);
  if (cell.runs.size() == 1) return command;
  return command.replace(command.find(one), one.size(),
                         fmt::format("--seeds {}..{} ", first.seed, next - 1));
}

// [optimizer, targets reached by each run, [medians by measure], runs failed, runs missing, [record
// of each run, or of the first], x, command]: what the page chooses from. The optimizer alone where
// the pair makes no sense. A record without a build has that of the first.
std::string cell_json(const Comparison& c, std::size_t p, std::size_t s) {
  const Cell& cell = c.cell(p, s);
  if (!cell.runs.empty() && !cell.is_measured()) return fmt::format("[{}]", s);
  std::vector<std::string> reached;
  for (const std::size_t run : cell.runs)
    reached.push_back(std::to_string(c.runs[run].returned_met));
  constexpr std::size_t kEach = 6;
  const std::size_t most = is_large(c) ? 1 : kEach;
  const std::span runs(cell.runs.data(), std::min(most, cell.runs.size()));
  const std::string build = runs.empty() ? "" : c.runs[runs[0]].record->build;
  const std::string records = json_list(runs, [&](std::size_t run) {
    const Record& record = *c.runs[run].record;
    const std::string name = record.file_name();
    const bool is_known = run != runs[0] && record.build == build;
    return json_quoted(is_known ? record.cell : name.substr(0, name.find('.')));
  });
  return fmt::format(
      "[{},{},{},{},{},{}{}]", s, repeats_json(reached), medians_json(c, cell), cell.failed,
      cell.missing(), records,
      is_large(c) || cell.runs.empty()
          ? ""
          : fmt::format(",{},{}", answer_json(c, cell.runs), json_quoted(cell_command(c, cell))));
}

// {"optimizer": "3.8e-5, tuned"}, of those whose options a table of rates chose.
std::string origins_json(const Comparison& c, std::size_t p) {
  std::string text;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (const std::string origin = origin_text(c, p, s); !origin.empty())
      text += fmt::format("{}\"{}\":{}", text.empty() ? "" : ",", s, json_quoted(origin));
  return text.empty() ? "" : ",\"origins\":{" + text + "}";
}

std::vector<Real> values_of(const AtEqualWork& method) {
  std::vector<Real> values;
  for (const auto& [seed, error] : method.errors) values.push_back(error);
  return values;
}

// What is learned, at equal work: [optimizer, error in x, its least, its greatest, loss, runs, how
// many of them diverged, the forward solves and the milliseconds of a step]; and of two methods how
// many times larger the error of the second is, its 95 % interval, 0 and null of too few runs, the
// p of Mann and Whitney, and whether a table reads the ratio in other ways too.
std::string learned_json(const Comparison& c, const RatioClaims& claims, std::size_t p) {
  if (!c.problems[p].is_learned) return "";
  const EqualWork equal = equal_work(c, p);
  const auto row = [&](std::size_t s) {
    const AtEqualWork& at = *equal.methods[s];
    const auto [work, milliseconds] = step_costs(c, c.cell(p, s));
    return fmt::format("[{},{},{},{},{},{},{},{},{:.3g}]", s, number(at.x_error.median),
                       number(at.x_error.low), number(at.x_error.high), number(at.loss.median),
                       at.x_error.n, at.diverged, number(std::isfinite(work) ? work : 0),
                       std::isfinite(milliseconds) ? milliseconds : 0);
  };
  const std::vector<std::size_t> order = equal.nearest_first();
  std::vector<std::string> pairs;
  for (const std::size_t a : order)
    for (const std::size_t b : order) {
      const AtEqualWork &first = *equal.methods[a], &second = *equal.methods[b];
      if (a == b || !(first.x_error.median > 0) || second.x_error.median < first.x_error.median)
        continue;
      const TimesLarger times = times_larger(first, second);
      const bool has_interval = times.interval && !times.is_range();
      const bool is_listed = claims.contains({p, a, b}) || claims.contains({p, b, a});
      pairs.push_back(fmt::format("[{},{},{},{},{},{:.2g},{}]", a, b, number(times.times),
                                  number(has_interval ? times.interval->low : 0),
                                  number(has_interval ? times.interval->high : kNever),
                                  mann_whitney_p(values_of(first), values_of(second)),
                                  is_listed ? 1 : 0));
    }
  return fmt::format(",\"learned\":{{\"work\":{},\"rows\":{},\"pairs\":[{}]}}", number(equal.work),
                     json_list(order, row), joined(pairs, ","));
}

// What runs over contours, or else over fields: [[optimizer, seed, work when it reached the
// tolerance or null, [work of each point or field that the page has]], …].
std::string race_json(const Comparison& c, std::size_t p,
                      const std::optional<FoundFields>& fields) {
  std::vector<std::string> runners;
  const auto add = [&](std::size_t s, const Run& run, const std::vector<std::size_t>& kept) {
    const std::string works =
        json_list(kept, [&](std::size_t i) { return std::to_string(run.record->curve.work[i]); });
    runners.push_back(fmt::format("[{},{},{},{}]", s, json_quoted(seed_text(run.seed)),
                                  number(c.taken(run, Measure::work, kTightest)), works));
  };
  if (has_planes(c, p)) {
    for (const Path& path : paths(c, p)) add(path.optimizer, *path.run, path.kept);
  } else if (fields) {
    for (const FoundField& found : fields->found)
      for (const std::size_t row : c.cell(p, found.optimizer).runs) {
        const Run& run = c.runs[row];
        if (run.seed != fields->seed) continue;
        std::vector<std::size_t> kept;
        for (const std::int64_t iteration : found.frames.iterations)
          kept.push_back(point_at(run.record->curve.iteration, iteration));
        add(found.optimizer, run, kept);
        break;
      }
  }
  return "[" + joined(runners, ",") + "]";
}

std::string problem_json(const Comparison& c, const RatioClaims& claims, std::size_t p,
                         const std::optional<FoundFields>& fields) {
  const ProblemAxis& problem = c.problems[p];
  std::vector<std::size_t> asked;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (c.cell(p, s).planned > 0) asked.push_back(s);
  const std::vector<std::size_t> ranked = ranking(c, p);
  return fmt::format(
             "{{\"spec\":{},\"name\":{},\"group\":\"{}\",\"isOrdered\":{},\"cells\":{},"
             "\"order\":{},\"lines\":{}",
             json_quoted(problem_name(problem)), json_quoted(problem.name), problem.group(),
             is_ordered(c, p), json_list(asked, [&](std::size_t s) { return cell_json(c, p, s); }),
             indices(ranked), indices(shown_at_first(c, ranked))) +
         origins_json(c, p) + learned_json(c, claims, p) +
         (problem.lacks_least_loss() ? ",\"isUnknown\":true" : "") +
         (problem.least_goal > 0 && problem.least_goal < kNever
              ? fmt::format(",\"goal\":{:.4g}", problem.least_goal)
              : "") +
         (prices_of(problem) ? ",\"sheet\":" + json_quoted(problem.sheet->file_name()) : "") +
         (fields ? ",\"fields\":" + fields_json(*fields) : "") +
         ",\"race\":" + race_json(c, p, fields) + ",\"curves\":" + curves_json(c, p) + "}";
}

// {"id": [optimizers, problems]}: what the cells that decide a claim are about.
std::string claims_about(const Document& document) {
  const Comparison& c = document.comparison;
  std::unordered_map<std::string_view, const Run*> by_cell;
  for (const Run& run : c.runs) by_cell.emplace(run.record->cell, &run);
  std::string text = "{";
  for (const Judgement& judgement : document.claims) {
    std::set<std::size_t> optimizers, problems;
    for (const std::string& cell : judgement.cells)
      if (const auto at = by_cell.find(cell); at != by_cell.end()) {
        optimizers.insert(at->second->optimizer);
        problems.insert(at->second->problem);
      }
    text += fmt::format("{}{}:[{},{}]", text.size() > 1 ? "," : "", json_quoted(judgement.id),
                        indices(optimizers), indices(problems));
  }
  return text + "}";
}

// [optimizer, score, solved, wins, median slowdown, runs that get there] of each, one after the
// other.
std::string places_json(const std::vector<Ranked>& places) {
  return json_list(places, [](const Ranked& place) {
    const Standing& standing = place.standing;
    return fmt::format("{},{:.5f},{},{},{},{}", place.optimizer, standing.score, standing.solved,
                       standing.wins,
                       standing.typical < kNever ? fmt::format("{:.3g}", standing.typical) : "null",
                       standing.reached);
  });
}

// By measure and target; 0 where they are those of the target before.
std::string standings_json(const Comparison& c) {
  const std::vector<Measure> measures = measures_of(c);
  const std::vector<std::size_t> targets = targets_of(c);
  const std::size_t n = targets.size();
  std::vector<std::string> all(measures.size() * n);
  share(all.size(), [&](std::size_t i) {
    all[i] = places_json(standings_to(c, measures[i / n], targets[i % n]));
  });
  std::string text = "[";
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_first = i % n == 0;
    text += i == 0 ? "[" : is_first ? "],[" : ",";
    text += !is_first && all[i] == all[i - 1] ? "0" : all[i];
  }
  return text + "]]";
}

// Methods that see more on some settings than on others are not ranked: [settings, runs, failed,
// place as above] among the ranked on those settings of the order that it was run on.
std::string pinned_json(const Comparison& c) {
  std::vector<std::string> all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    if (!c.optimizers[s].is_meaning) continue;
    std::vector<Ranked> places = standings_beside(c, s);
    if (places.empty()) continue;
    std::erase_if(places, [&](const Ranked& place) { return place.optimizer != s; });
    const Standing& own = places[0].standing;
    all.push_back(fmt::format("[{},{},{},{}]", own.settings, own.runs, c.optimizers[s].failed,
                              places_json(places)));
  }
  return "[" + joined(all, ",") + "]";
}

// The nominal cost of a Jacobian on each common setting and, for each ranked method, the calls of
// its runs until they reached the tolerance: [work without pullbacks and Jacobians, pullbacks,
// Jacobians, the first in rounds of 8 workers, of 64] of each run, one after the other; null of a
// run that did not, and of one that is missing. Last, the weight of the setting in a score.
std::string calls_json(const Comparison& c) {
  if (is_large(c)) return "[]";
  constexpr auto kPullback = static_cast<std::size_t>(Oracle::pullback),
                 kJacobian = static_cast<std::size_t>(Oracle::jacobian);
  std::map<std::string, std::size_t> families;  // settings
  for (const std::size_t p : c.order.settings) ++families[c.problems[p].family()];
  return json_list(c.order.settings, [&](std::size_t p) {
    std::uint64_t declared = 0;
    const std::string methods = json_list(c.order.methods, [&](std::size_t s) {
      const Cell& cell = c.cell(p, s);
      constexpr const char* kNone = "null,null,null,null,null";
      std::vector<std::string> texts(cell.missing(), kNone);
      for (const std::size_t row : cell.runs) {
        const Record& record = *c.runs[row].record;
        const Real work = c.taken(c.runs[row], Measure::work, kTightest);
        if (work == kNever) {
          texts.emplace_back(kNone);
          continue;
        }
        const OracleCounts counts = counts_at(record, work);
        const auto spent = [&](std::size_t kind) {
          return Real(record.prices[kind]) * Real(counts[kind]);
        };
        declared = std::max<std::uint64_t>(declared, record.prices[kJacobian]);
        const Real derivatives = spent(kPullback) + spent(kJacobian);
        texts.push_back(
            fmt::format("{},{},{}", work - derivatives, counts[kPullback], counts[kJacobian]));
        for (const std::int64_t workers : kWorkers)
          texts.back() += fmt::format(",{}", rounds_at(record, work, workers) - derivatives);
      }
      return "[" + joined(texts, ",") + "]";
    });
    return fmt::format("[{},{},{}]", declared, methods,
                       1 / Real(families.size() * families[c.problems[p].family()]));
  });
}

// What does not change from target to target: [settings, runs, failed, score's interval].
std::string given_json(const Comparison& c) {
  const std::vector<Interval> intervals = score_intervals(c);
  std::size_t s = 0;
  return json_list(c.optimizers, [&](const OptimizerAxis& axis) {
    const Interval& interval = intervals[s++];
    return fmt::format("[{},{},{},{},{}]", axis.tightest().settings, axis.tightest().runs,
                       axis.failed, number(interval.low), number(interval.high));
  });
}

std::string axes_json(const Comparison& c) {
  const auto texts = [&](auto text) {
    return json_list(c.optimizers,
                     [&](const OptimizerAxis& axis) { return json_quoted(text(axis)); });
  };
  return fmt::format(
      "\"optimizers\":{},\"methods\":{},\"kinds\":{},\"privileges\":{},\"marks\":{},\"shapes\":{},"
      "\"asks\":{}",
      texts([](const OptimizerAxis& axis) { return optimizer_name(axis); }),
      texts([](const OptimizerAxis& axis) { return axis.method; }),
      texts([](const OptimizerAxis& axis) { return kind_title(axis.mathematics()); }),
      texts([](const OptimizerAxis& axis) { return joined(axis.privileges); }), texts(marks_of),
      texts([](const OptimizerAxis& axis) { return std::string(look_of(axis.method).shape); }),
      json_list(std::views::iota(std::size_t{0}, c.optimizers.size()),
                [&](std::size_t s) { return json_quoted(counted_oracles(c, s)); }));
}

// name, what is counted, its unit, the least that counts.
std::string measures_json(const Comparison& c) {
  return json_list(measures_of(c), [](Measure by) {
    return fmt::format("{{\"name\":\"{}\",\"counted\":\"{}\",\"unit\":\"{}\",\"least\":{}}}",
                       name_of(by), counted_name(by), unit_name(by),
                       by == Measure::time ? "1e-3" : "1");
  });
}

// The sentences of scripts, which these fill, or the meanings of terms; by key.
std::string script_words(std::string_view prefix) {
  std::vector<std::string> all;
  for (const auto& [key, sentence] : all_sentences())
    if (key.starts_with(prefix))
      all.push_back(json_quoted(key.substr(prefix.size())) + ":" + json_quoted(sentence.text));
  return "{" + joined(all, ",") + "}";
}

// The advice for every choice of means by derivatives, inverse, size, budget and kind of data, each
// with its text, its settings and [optimizer, solved, settings, score, median work,
// whether in the group] of its methods, one after the other.
constexpr std::array<std::array<Index, 2>, 4> kSizes = {
    {{0, Means{}.most_unknowns}, kSizeClasses[0], kSizeClasses[1], kSizeClasses[2]}};
constexpr std::array<Real, 4> kBudgets = {kNever, 10'000, 1'000, 100};

std::string kinds_json(const Comparison& c) {
  return json_list(kinds_of_data(c), [](const Means& kind) {
    return json_quoted(kind.has_bounds     ? words("data.bounds")
                       : kind.has_failures ? words("data.failures")
                       : kind.noise > 0    ? words("data.noise", 100 * kind.noise)
                                           : words("data.exact"));
  });
}

std::string advice_json(const Comparison& c) {
  if (is_large(c)) return "[]";  // each is a decision of its own
  const std::vector<Means> kinds = kinds_of_data(c);
  constexpr std::size_t kMost = 10;
  const std::size_t budgets = kBudgets.size() * kinds.size(), each = kSizes.size() * budgets;
  std::vector<std::string> all(2 * kDerivativeNames.size() * each);
  share(all.size(), [&](std::size_t i) {
    const auto& [least, most] = kSizes[i / budgets % kSizes.size()];
    const Means& kind = kinds[i % kinds.size()];
    const Means means{.derivatives = static_cast<Derivatives>(i / (2 * each)),
                      .has_inverse = i / each % 2 == 1,
                      .least_unknowns = least,
                      .most_unknowns = most,
                      .budget = kBudgets[i / kinds.size() % kBudgets.size()],
                      .noise = kind.noise,
                      .has_bounds = kind.has_bounds,
                      .has_failures = kind.has_failures};
    const Advice advice = advise(c, means);
    const std::size_t shown = std::min(kMost, advice.ranked.size());
    all[i] = fmt::format(
        "[{},{},{}]", json_quoted(advice_text(c, means, advice)), advice.settings.size(),
        json_list(advice.ranked | std::views::take(shown), [](const Advised& one) {
          return fmt::format("{},{},{},{:.3g},{},{}", one.optimizer, one.solved, one.settings,
                             one.score, number(one.work), one.is_in_group ? 1 : 0);
        }));
  });
  return json_list(all, [](const std::string& text) { return text; });
}

}  // namespace

std::string json_quoted(const std::string& text) { return json_text(Json(text)); }

std::string page_data(const Document& document, const AllFields& fields) {
  const Comparison& c = document.comparison;
  std::string text = fmt::format(
      "{{\"runs\":{},\"by\":\"{}\",\"allLearned\":{},\"shades\":{},\"measures\":{},"
      "\"isTimedTogether\":{},"
      "\"rungs\":{},\"targets\":{},{},\"given\":{},\"ranked\":{},\"common\":{},\"sanity\":{},"
      "\"claims\":{},"
      "\"pinned\":{},\"group\":{},\"dataKinds\":{},\"advice\":{},\"words\":{},\"terms\":{},"
      "\"calls\":{},\"standings\":{},\"guide\":{},\"rest\":{},\"problems\":[",
      json_quoted(runs_address(document)), name_of(c.yardstick.by), is_all_learned(c),
      json_list(kShades, exact_figure), measures_json(c), c.is_any_timed_together,
      json_list(c.yardstick.tolerances,
                [](const Tolerance& tolerance) { return std::to_string(tolerance.rung); }),
      indices(targets_of(c)), axes_json(c), given_json(c), indices(c.order.methods),
      indices(c.order.settings), indices(c.sanity.settings), claims_about(document), pinned_json(c),
      indices(c.decision ? c.decision->group() : std::vector<std::size_t>()), kinds_json(c),
      advice_json(c), script_words("script."), script_words("glossary."), calls_json(c),
      standings_json(c), json_quoted(std::string(embedded_guide())), figure_lines_json(document));
  const RatioClaims claims = ratio_claims(c, document.claims);
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    text += (p > 0 ? "," : "") + problem_json(c, claims, p, fields[p]);
  return text + "]}";
}

}  // namespace isoline::reports
