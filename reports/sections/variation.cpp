// How much of the variation of the work of a method lies between instances, how much between
// starts, and how much in neither alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/results/statistics.h"
#include "core/seeds.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

struct Variation {
  std::array<std::vector<Real>, 3> shares = {};  // of instances, starts, neither alone: [setting]
  std::vector<Real> deviation = {};              // of the whole, in doublings
  std::size_t left_out = 0;                      // settings

  std::size_t used() const { return deviation.size(); }
  TableCell share_cell(const char* name, std::size_t part) const {
    if (used() == 0) return "";
    const Real share = median_of(shares[part]);
    return {percent(share), {{name, share}}};
  }
};

// Adds one setting if its instances and starts are crossed: runs outnumber both.
void add_setting(const Comparison& c, Rows runs, Variation& all) {
  std::ranges::sort(runs, {}, [&](std::size_t row) {
    return std::pair(instance_of(c.runs[row].seed), start_of(c.runs[row].seed));
  });
  std::vector<std::uint64_t> seeds;
  for (const std::size_t row : runs) seeds.push_back(c.runs[row].seed);
  const std::size_t instances = distinct(seeds, instance_of), starts = distinct(seeds, start_of);
  if (std::min(instances, starts) < 2 || runs.size() <= std::max(instances, starts)) return;
  std::vector<std::vector<Real>> doublings(instances);
  bool is_solved = runs.size() == instances * starts;
  for (std::size_t i = 0; i < runs.size() && is_solved; ++i) {
    const Real cost = c.taken(c.runs[runs[i]], c.yardstick.by, kTightest);
    is_solved = cost < kNever;
    doublings[i / starts].push_back(std::log2(std::max(cost / least_unit(c.yardstick.by), 1.0)));
  }
  constexpr Real kRounding = 1e-20;  // of squares, where all are equal
  const auto parts = is_solved ? variance_components(doublings) : VarianceComponents{};
  if (parts.total() < kRounding) {
    ++all.left_out;
    return;
  }
  const std::array<Real, 3> sizes = {parts.first, parts.second, parts.rest};
  for (std::size_t i = 0; i < sizes.size(); ++i) all.shares[i].push_back(sizes[i] / parts.total());
  all.deviation.push_back(std::sqrt(parts.total()));
}

}  // namespace

Table variation_table(const Comparison& c) {
  Table table = worded_table("variation", counted_name(c), tau_name(c));
  Variation all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    Variation own;
    for (std::size_t p = 0; p < c.problems.size(); ++p)
      for (Variation* each : {&own, &all})
        if (c.cell(p, s).is_measured()) add_setting(c, c.cell(p, s).runs, *each);
    if (own.used() + own.left_out == 0 || table.rows.size() == kMostTableRows) continue;
    add_row(table, c, s,
            {count_cell(own.used()), own.share_cell("instances", 0), own.share_cell("starts", 1),
             own.share_cell("rest", 2),
             own.used() == 0 ? TableCell("") : number_cell("deviation", median_of(own.deviation)),
             count_cell(own.left_out)});
  }
  if (table.rows.empty()) return {};
  const auto share = [&](std::size_t part) { return all.share_cell("share", part).text; };
  table.reading = all.used() == 0 ? words("variation.none", all.left_out)
                                  : words("variation.reading", all.used(), share(0), share(1),
                                          share(2), all.left_out);
  return table;
}

}  // namespace isoline::reports
