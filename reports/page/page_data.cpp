// What the scripts of the page choose from: names, standings to every target by every measure, and
// the problems' own data.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>
#include <unordered_map>

#include "core/threads.h"
#include "reports/page/chart_data.h"
#include "reports/page/compact_json.h"
#include "reports/page/kinds.h"
#include "reports/page/page.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

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
                        indices({optimizers.begin(), optimizers.end()}),
                        indices({problems.begin(), problems.end()}));
  }
  return text + "}";
}

// [optimizer, score, solved, best on, × least, runs that get there] of each, one after the other.
std::string places_json(const std::vector<Ranked>& places) {
  return list(places, [](const Ranked& place) {
    const Standing& standing = place.standing;
    return fmt::format("{},{:.4g},{},{},{},{}", place.optimizer, standing.score, standing.solved,
                       standing.wins, coarse(standing.typical), standing.reached);
  });
}

// By measure and target; 0 where they are those of the target before.
std::string standings_json(const Comparison& c, const Ladders& ladders) {
  const std::vector<Measure> measures = measures_of(c);
  const std::vector<std::size_t> targets = targets_of(c);
  const std::size_t n = targets.size();
  std::vector<std::string> all(measures.size() * n);
  share(all.size(), [&](std::size_t i) {
    all[i] = places_json(ladders.standings(measures[i / n], targets[i % n]));
  });
  std::string text = "[";
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_first = i % n == 0;
    text += i == 0 ? "[" : is_first ? "],[" : ",";
    text += !is_first && all[i] == all[i - 1] ? "0" : all[i];
  }
  return text + "]]";
}

// What does not change from target to target: [settings, runs, failed, score's interval].
std::string given_json(const Comparison& c, const std::vector<Interval>& intervals) {
  std::vector<std::size_t> all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) all.push_back(s);
  return list(all, [&](std::size_t s) {
    const OptimizerAxis& axis = c.optimizers[s];
    return fmt::format("[{},{},{},{},{}]", axis.tightest().settings, axis.tightest().runs,
                       axis.failed, coarse(intervals[s].low), coarse(intervals[s].high));
  });
}

template <class Text>
std::string of_optimizers(const Comparison& c, Text text) {
  return list(c.optimizers, [&](const OptimizerAxis& axis) { return json_quoted(text(axis)); });
}

std::string axes_json(const Comparison& c) {
  const auto asks = [](const OptimizerAxis& axis) {
    return axis.sheet == nullptr ? std::string() : joined(axis.sheet->oracles);
  };
  const auto style = [](const OptimizerAxis& axis) {
    const LineStyle line = style_of(axis);
    return fmt::format("[\"{}\",\"{}\",{}]", kMathematics[line.kind], kDashes[line.dash],
                       line.marker);
  };
  return fmt::format(
      "\"optimizers\":{},\"labels\":{},\"methods\":{},\"kinds\":{},\"styles\":{},"
      "\"privileges\":{},\"marks\":{},\"asks\":{}",
      of_optimizers(c, [](const OptimizerAxis& axis) { return optimizer_name(axis); }),
      of_optimizers(c,
                    [](const OptimizerAxis& axis) {
                      return shown_spec(axis.label) + (axis.is_foreign ? " ‡" : "");
                    }),
      of_optimizers(c, [](const OptimizerAxis& axis) { return axis.method; }),
      of_optimizers(c, [](const OptimizerAxis& axis) { return kind_title(axis.mathematics()); }),
      list(c.optimizers, style),
      of_optimizers(c, [](const OptimizerAxis& axis) { return joined(axis.privileges); }),
      of_optimizers(c, marks_of), of_optimizers(c, asks));
}

// name, what is counted, its unit, whether medians are whole or halves, the least that counts.
std::string measures_json(const Comparison& c) {
  return list(measures_of(c), [](Measure by) {
    const bool is_count = by == Measure::work || by == Measure::iterations;
    return fmt::format(
        "{{\"name\":\"{}\",\"counted\":\"{}\",\"unit\":\"{}\",\"isCount\":{},\"least\":{}}}",
        name_of(by), counted_name(by), unit_name(by), is_count, by == Measure::time ? "1e-3" : "1");
  });
}

// No </script and no <!-- can stand in it.
std::string safe(const std::string& text) {
  std::string out;
  for (const char letter : text)
    if (letter == '<')
      out += "\\u003c";
    else
      out += letter;
  return out;
}

}  // namespace

std::string page_data(const Document& document, const std::vector<Interval>& intervals,
                      const AllFields& fields) {
  const Comparison& c = document.comparison;
  const Ladders ladders(c);
  std::string text = fmt::format(
      "{{\"by\":\"{}\",\"shownAtFirst\":{},\"shades\":{},\"measures\":{},\"isTimedTogether\":{},\"rungs\":{},\"targets\":{},{},\"given\":{},"
      "\"ranked\":{},\"common\":{},\"claims\":{},\"figures\":{},\"standings\":{},\"problems\":[",
      name_of(c.yardstick.by), kShownAtFirst, list(kShades, exact_figure), measures_json(c),
      c.is_any_timed_together,
      list(c.yardstick.tolerances,
           [](const Tolerance& tolerance) { return std::to_string(tolerance.rung); }),
      indices(targets_of(c)), axes_json(c), given_json(c, intervals), indices(c.order.methods),
      indices(c.order.settings), claims_about(document), figures_json(document.figures),
      standings_json(c, ladders));
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    text += (p > 0 ? "," : "") + problem_data(c, ladders, p, fields[p]);
  return safe(text + "]}");
}

}  // namespace isoline::reports
