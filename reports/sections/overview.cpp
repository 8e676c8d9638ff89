// Orders the sections of a report, and writes its first sentences and the summaries of its charts.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>

#include "core/files.h"
#include "core/seeds.h"
#include "core/threads.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

const Section& Document::section(std::string_view id) const {
  return *std::ranges::find(sections, id, &Section::id);
}

Document document_of(Comparison comparison, std::vector<Judgement> claims) {
  Document document{.comparison = std::move(comparison), .claims = std::move(claims)};
  const Comparison& c = document.comparison;
  document.headline = headline(c);
  document.statuses = status_text(c.statuses);
  document.incomplete = missing_text(c);
  document.remarks = remarks(c);
  const auto make = std::to_array<std::function<Section()>>({
      [&] { return fit_section(c); },
      [&] { return standings_section(c); },
      [&] { return problems_section(c); },
      [&] { return learned_section(c, document.claims); },
      [&] { return amortized_section(c); },
      [&] { return sweeps_section(c); },
      [&] { return spectra_section(c); },
      [&] { return claims_section(document.claims); },
      [&] { return properties_section(c.study->audits); },
      [&] { return conduct_section(c.study->audits); },
      [&] { return tuning_section(c); },
      [&] { return statistics_section(c); },
      [&] { return failures_section(c); },
      [&] { return builds_section(c); },
  });
  document.sections.resize(make.size());
  share(make.size() + 1, [&](std::size_t i) {
    if (i < make.size())
      document.sections[i] = make[i]();
    else
      document.figures = figures(c);
  });
  if (document.sections[0].is_empty()) document.sections.erase(document.sections.begin());
  add_published(document.figures, c, document.claims);
  return document;
}

namespace {

// The number of methods: all, or those that were run on a problem.
std::size_t methods_of(const Comparison& c, std::optional<std::size_t> problem = {}) {
  std::set<std::string> names;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (!problem || c.cell(*problem, s).planned > 0) names.insert(c.optimizers[s].name_of_all());
  return names.size();
}

// The solvers with the greatest share within a factor.
Leading leaders(const Comparison& c, const Profile& profile, Real factor) {
  Leading first;
  for (const std::size_t s : c.order.methods)
    first.offer(profile.share(s, factor), name_in_sentence(c.optimizers[s]));
  return first;
}

// "solves this setting to 1e-6", or what replaces it where 1.1 times the floor is larger.
std::string goal_text(const Comparison& c, std::size_t problem, std::size_t methods) {
  const Real least = c.problems[problem].least_goal;
  if (is_judged_by_fit(c, problem)) return words("curve.fit", methods);
  return least > c.yardstick.tightest().tau
             ? words("curve.floor", methods, least)
             : words("curve.solve", methods, setting_noun(c), tau_name(c));
}

// "adam 0.011 to 0.029", or one number.
std::string range_of(const Comparison& c, std::size_t method, const Spread& spread) {
  const std::string low = reached_figure(spread.low), high = reached_figure(spread.high);
  const std::string name = name_in_sentence(c.optimizers[method]);
  return low == high ? name + " " + low : words("learned.range", name, low, high);
}

std::string unsolved_reading(const Comparison& c, std::size_t problem,
                             const std::vector<std::size_t>& order) {
  const bool is_in_x = c.problems[problem].aim == Aim::x;
  const auto spread_at_end = [&](std::size_t s) {
    const Cell& cell = c.cell(problem, s);
    if (!is_in_x) return cell.loss;
    return c.aggregate(cell.runs, [](const Run& run) {
      return run.record->summary.x_error / run.record->x_scale.value_or(1);
    });
  };
  const auto end_of = [&](std::size_t s) { return spread_at_end(s).median; };
  std::vector<std::size_t> nearest = order;
  std::ranges::stable_sort(nearest, {}, end_of);
  const std::size_t best = nearest[0];
  const Real least = end_of(best);
  if (c.problems[problem].lacks_least_loss() && least < kNever)  // in order of their losses
    return words("curve.unknown", name_in_sentence(c.optimizers[best]), least,
                 order.size() < 2
                     ? ""
                     : words("curve.next-loss", name_in_sentence(c.optimizers[order[1]]),
                             reached_figure(end_of(order[1]))));
  if (const std::size_t seeds = spread_at_end(best).n;
      least < kNever && (nearest.size() == 1 || seeds < kFewestForInterval)) {
    std::vector<std::string> ranges;
    for (std::size_t i = 0; i < std::min<std::size_t>(nearest.size(), 2); ++i)
      ranges.push_back(range_of(c, nearest[i], spread_at_end(nearest[i])));
    return words(is_in_x ? "curve.errors" : "curve.losses", goal_text(c, problem, 1), seeds,
                 joined(ranges, "; "));
  }
  return words(!(least < kNever) ? "curve.none-finite"
               : is_in_x         ? "curve.least-error"
                                 : "curve.least-loss",
               goal_text(c, problem, 1), name_in_sentence(c.optimizers[best]), least);
}

// " (90–300 over seeds)"
std::string range_note(const Comparison& c, std::size_t problem, std::size_t method) {
  const std::string range =
      range_figure(c.cell(problem, method).headline[kTightest],
                   c.yardstick.by == Measure::time ? milliseconds : reached_figure);
  return range.empty() ? "" : words("curve.range", range);
}

// "; next is adam, with 1.3× the median work", and on how many of the seeds that both ran the first
// took less.
std::string runner_up(const Comparison& c, std::size_t problem, std::size_t one,
                      std::size_t other) {
  const Cell &first = c.cell(problem, one), &second = c.cell(problem, other);
  const Real best = first.headline[kTightest].median, next = second.headline[kTightest].median;
  const auto pairs = c.join(first.runs, second.runs, [](const Run& run) { return run.seed; });
  const auto less = std::ranges::count_if(pairs, [&](const auto& pair) {
    return c.taken(c.runs[pair.first], c.yardstick.by, kTightest) <
           c.taken(c.runs[pair.second], c.yardstick.by, kTightest);
  });
  const std::string range =
      second.headline[kTightest].n < kFewestForInterval ? range_note(c, problem, other) : "";
  return words("curve.next", name_in_sentence(c.optimizers[other]),
               multiple(next / std::max(best, least_unit(c.yardstick.by))), counted_name(c),
               range.empty() ? "" : " (" + range + ")",
               pairs.size() < 2 ? ""
                                : " " + words("curve.seeds", name_in_sentence(c.optimizers[one]),
                                              less, pairs.size()));
}

}  // namespace

std::string missing_text(const Comparison& comparison) {
  constexpr std::size_t kNamed = 5;
  const auto& missing = comparison.missing;
  if (missing.empty()) return "";
  std::vector<std::string> cells;
  for (std::size_t i = 0; i < missing.size() && i < kNamed; ++i)
    cells.push_back(words("overview.cell", missing[i].problem, missing[i].optimizer,
                          seed_text(missing[i].seed)));
  const std::size_t more = missing.size() - cells.size();
  return words("overview.missing", comparison.answered, comparison.planned, joined(cells, "; "),
               more == 0 ? "" : words("overview.more", more));
}

std::string headline(const Comparison& c) {
  std::map<std::size_t, std::set<std::uint64_t>> seeds;  // by problem
  for (const Run& run : c.runs) seeds[run.problem].insert(run.seed);
  const bool is_limit = std::ranges::any_of(
      seeds, [&](const auto& own) { return own.second.size() < c.seeds.size(); });
  return words(c.problems.size() > c.names ? "overview.headline-settings" : "overview.headline",
               methods_of(c), c.names, c.problems.size(),
               is_limit ? words("overview.at-most") + " " : "", c.seeds.size(),
               c.study->runs.size());
}

// The lines "# doi: 10.5281/zenodo.1234" of the manifest of a result folder, which is of sha256sum.
static std::vector<std::string> dois_of(const std::filesystem::path& folder) {
  constexpr std::string_view kLead = "# doi: ";
  const std::filesystem::path manifest = folder / "SHA256SUMS";
  std::vector<std::string> dois;
  if (!is_there(manifest)) return dois;
  std::istringstream lines(read_text(manifest));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(kLead)) dois.push_back(line.substr(kLead.size()));
  return dois;
}

std::string unchecked_text(const Comparison& c) {
  std::vector<std::string> names;
  for (const ProblemAxis& problem : c.problems)
    if (problem.is_unchecked) names.push_back(problem_name(problem));
  return names.empty() ? "" : words("remarks.unchecked", joined(names));
}

std::vector<std::string> remarks(const Comparison& c) {
  const Study& study = *c.study;
  std::vector<std::string> all;
  constexpr std::size_t kNamed = 8;
  for (const std::filesystem::path folder : study.folders)
    for (const std::string& doi : dois_of(folder))
      all.push_back(words("remarks.doi", folder.filename().string(), doi));
  std::vector<std::string> partial;  // problems that were not planned for every optimizer
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    if (const std::size_t planned = methods_of(c, p); planned < methods_of(c))
      partial.push_back(words("remarks.count", problem_name(c.problems[p]), planned));
  if (!partial.empty())
    all.push_back(words("remarks.partial", counted_settings(c, c.order.settings.size()),
                        methods_of(c), first_of(partial, kNamed)));
  std::vector<std::string> budgets;
  for (const OptimizerAxis& optimizer : c.optimizers)
    if (optimizer.has_budgets) budgets.push_back(name_in_sentence(optimizer));
  if (!budgets.empty()) all.push_back(words("remarks.budgets", first_of(budgets, kNamed)));
  if (study.superseded > 0) all.push_back(words("remarks.superseded", study.superseded));
  if (!study.unreadable.empty())
    all.push_back(words("remarks.unreadable", study.unreadable.size()));
  if (c.is_any_timed_together) all.push_back(words("remarks.shared-time"));
  std::map<std::string, std::set<std::string>> sources;  // of imported runs, by method
  for (const Run& run : c.runs)
    if (run.record->imported)
      sources[run.record->request.optimizer.name].insert(run.record->imported->source);
  std::vector<std::string> named;
  for (const auto& [method, those] : sources)
    named.push_back(words("remarks.source", method, joined({those.begin(), those.end()}, "; ")));
  if (!named.empty()) all.push_back(words("remarks.imported", joined(named)));
  std::map<std::string, std::vector<std::string>> unknown;  // by sentence
  for (const ProblemAxis& problem : c.problems)
    if (!problem.is_minimum_known)
      unknown[problem.is_least_of_runs ? "remarks.least-of-runs" : "remarks.no-minimum"].push_back(
          problem_name(problem));
  for (const auto& [key, problems] : unknown) all.push_back(words(key, joined(problems)));
  const auto has_fit = [](const Run& run) { return run.record->fit.has_value(); };
  if (std::string text = unchecked_text(c); std::ranges::none_of(c.runs, has_fit) && !text.empty())
    all.push_back(std::move(text));  // else the fit says it
  return all;
}

std::string profile_reading(const Comparison& c, std::size_t tolerance) {
  const Profile& profile = c.profiles[tolerance];
  const Leading fast = leaders(c, profile, 2), robust = leaders(c, profile, kNever);
  const std::string_view tau = c.yardstick.tolerances[tolerance].name;
  if (robust.value == 0) return words("profile.none", tau);
  const auto text = [](const Leading& first) {  // if there are many, only their number
    constexpr std::size_t kNamed = 3;
    const std::size_t count = first.names.size();
    return count > kNamed ? words("profile.methods", count) : listed(first.names);
  };
  return words("profile.reading", text(fast), fast.names.size(), percent(fast.value), tau,
               counted_name(c), percent(robust.value), text(robust));
}

std::string curve_reading(const Comparison& c, std::size_t problem) {
  std::vector<std::size_t> order = ranking(c, problem);
  if (order.empty()) return words("curve.nothing", setting_noun(c));
  const auto work = [&](std::size_t s) { return c.cell(problem, s).headline[kTightest]; };
  std::ranges::stable_sort(order, {}, [&](std::size_t s) { return work(s).median; });
  const auto solved = static_cast<std::size_t>(
      std::ranges::count_if(order, [&](std::size_t s) { return work(s).is_solved(); }));
  if (solved == 0) return unsolved_reading(c, problem, order);
  const Spread first = work(order[0]);
  std::vector<std::string> tied;
  for (const std::size_t s : order) {
    if (!(work(s).median <= first.median)) break;
    tied.push_back(name_in_sentence(c.optimizers[s]));
  }
  const bool is_tied = tied.size() > 1;
  std::vector<std::string> notes;
  if (const std::string range = range_note(c, problem, order[0]); !range.empty() && !is_tied)
    notes.push_back(range);
  if (c.cell(problem, order[0]).is_bound[kTightest]) notes.push_back(words("curve.bound"));
  const std::size_t unsolved = order.size() - solved, next = tied.size();
  const std::string noted = notes.empty() ? "" : " (" + joined(notes, "; ") + ")";
  const std::string amount = amount_in_units(c, first.median), goal = goal_text(c, problem, 2);
  if (order.size() == 1) return words("curve.alone", tied[0], amount, goal, noted, setting_noun(c));
  return words("curve.least",
               first.n < kFewestForInterval ? words("curve.few", first.n) : words("curve.smallest"),
               counted_name(c), goal, is_tied ? words("curve.tied", listed(tied)) : tied[0], amount,
               noted, solved <= next ? "" : runner_up(c, problem, order[0], order[next]),
               words(unsolved > 0 ? "curve.unsolved" : "curve.all", unsolved, order.size(),
                     setting_noun(c)));
}

// The learned problems, at equal work.
std::vector<std::string> learned_sentences(const Comparison& c) {
  constexpr std::size_t kFew = 4, kNamed = 3;
  std::vector<std::string> all;
  std::map<std::string, std::size_t> nearest;
  std::size_t problems = 0;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!c.problems[p].is_learned) continue;
    const EqualWork equal = equal_work(c, p);
    const auto order = equal.nearest_first();
    if (order.empty() || !equal.methods[order[0]]->x_error.is_solved()) continue;
    const auto name = [&](std::size_t place) {
      return name_in_sentence(c.optimizers[order[place]]);
    };
    const auto spread = [&](std::size_t place) { return equal.methods[order[place]]->x_error; };
    const bool is_few = order.size() < 2 || spread(0).n < kFewestForInterval;
    if (!is_few) ++problems, ++nearest[name(0)];
    const Real least = equal.methods[order[0]]->x_error.median;
    const std::size_t diverged = equal.methods[order[0]]->diverged;
    std::string next;
    const TimesLarger times =
        order.size() < 2 ? TimesLarger{}
                         : times_larger(*equal.methods[order[0]], *equal.methods[order[1]]);
    if (order.size() > 1) {
      const std::string seeds =
          !times.interval
              ? ""
              : " " + words("learned.seeds", times.interval->low, times.interval->high,
                            words(times.is_range() ? "learned.seed-range" : "learned.interval"),
                            times.larger, times.seeds);
      next = words("learned.next", name(1), multiple(times.times), seeds);
    }
    if (all.size() >= kFew) continue;
    const std::string noted = diverged == 0 ? "" : " " + words("learned.diverged", diverged);
    if (is_few || (times.interval && times.interval->low <= 1)) {
      std::vector<std::string> ranges;
      for (std::size_t place = 0; place < std::min<std::size_t>(order.size(), 2); ++place)
        ranges.push_back(range_of(c, order[place], spread(place)));
      all.push_back(words("learned.ranges", problem_name(c.problems[p]), spread(0).n,
                          joined(ranges, "; "), noted));
      continue;
    }
    all.push_back(
        words("learned.nearest", problem_name(c.problems[p]), name(0), least, noted, next));
  }
  if (problems < 2) return all;
  std::vector<std::pair<std::string, std::size_t>> ranked(nearest.begin(), nearest.end());
  std::ranges::stable_sort(ranked, std::ranges::greater{},
                           &std::pair<std::string, std::size_t>::second);
  std::vector<std::string>
      parts;  // the number of problems on which each method has the smallest error in x
  for (const auto& [name, count] : ranked)
    if (parts.size() < kNamed) parts.push_back(words("learned.on", name, count));
  all.insert(all.begin(), words("learned.summary", problems, joined(parts)));
  return all;
}

}  // namespace isoline::reports
