// Regressions: the certified digits of each method per data set of NIST, and the standard
// deviations of x that least-squares runs keep.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/options.h"
#include "core/results/published_digits.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

std::string digits_text(Real digits) { return fmt::format("{:.1f}", digits); }

// The medians over seeds, by data set and then by start.
using Digits = std::map<std::string, std::map<Index, Real>>;
Digits digits_of(const Comparison& c, std::size_t s) {
  Digits all;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const Cell& cell = c.cell(p, s);
    if (c.problems[p].name != "nist" || !cell.is_measured()) continue;
    const OptionValues& options = c.runs[cell.runs[0]].record->request.problem.options;
    const auto start = static_cast<Index>(options.number("start", 1));
    const auto digits = [](const Run& run) { return returned_digits(*run.record); };
    all[options.text("dataset")][start] = c.aggregate(cell.runs, digits).median;
  }
  return all;
}

// All data sets and starts of a method.
struct Sum {
  std::size_t cells = 0, solved = 0, accurate = 0;
  Real digits = 0;

  Real mean() const { return digits / static_cast<Real>(cells); }
};
Sum sum_of(const Digits& all) {
  Sum sum;
  for (const auto& [name, starts] : all)
    for (const auto& [start, digits] : starts) {
      ++sum.cells;
      sum.digits += digits;
      sum.solved += digits >= kSolvedDigits;
      sum.accurate += digits >= kAccurateDigits;
    }
  return sum;
}

// "8.5 / 11.0", one number a start.
TableCell starts_cell(const Digits& all, const std::string& name) {
  const auto found = all.find(name);
  if (found == all.end()) return "";
  TableCell cell("");
  std::vector<std::string> texts;
  for (const auto& [start, digits] : found->second) {
    texts.push_back(digits_text(digits));
    cell.numbers.emplace_back(fmt::format("start {}", start), digits);
  }
  cell.text = joined(texts, " / ");
  return cell;
}

}  // namespace

Table certified_table(const Comparison& c) {
  constexpr std::size_t kSideBySide = 9;
  std::map<std::size_t, Digits> methods;
  std::set<std::string> names;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    Digits all = digits_of(c, s);
    for (const auto& [name, starts] : all) names.insert(name);
    if (!all.empty()) methods[s] = std::move(all);
  }
  if (methods.empty()) return {};
  Table table = worded_table("certified", kCertifiedDigits, kSolvedDigits, kAccurateDigits);
  table.most_columns = kSideBySide;
  for (const std::string& name : names) {
    table.columns.push_back(name);
    table.meanings.push_back(words("certified.set", name));
  }
  std::vector<std::pair<Real, std::size_t>> order;  // the greatest mean first
  for (const auto& [s, all] : methods) order.emplace_back(-sum_of(all).mean(), s);
  std::ranges::sort(order);
  for (const auto& [negative, s] : order) {
    if (table.rows.size() == kMostTableRows) break;
    const Sum sum = sum_of(methods[s]);
    std::vector<TableCell> row = {count_cell(sum.cells),
                                  {fmt::format("{:.2f}", sum.mean()), {{"mean", sum.mean()}}},
                                  count_cell(sum.solved),
                                  count_cell(sum.accurate)};
    for (const std::string& name : names) row.push_back(starts_cell(methods[s], name));
    add_row(table, c, s, std::move(row));
  }
  const Sum best = sum_of(methods[order[0].second]);
  table.reading = words("certified.reading", optimizer_text(c, order[0].second), best.solved,
                        best.cells, best.mean());
  for (const auto& [name, mean] : results::kPublishedDigits) {
    std::vector<TableCell>& row = table.rows.emplace_back(table.columns.size(), TableCell(""));
    row[0] = words("certified.published", name);
    row[2] = {digits_text(mean), {{"mean", mean}}};
  }
  return table;
}

namespace {

std::string name_of_unknown(const Record& record, std::size_t i) {
  return record.answer ? record.answer->name(i) : AnswerPoints().name(i);
}

std::string name_with_unit(const Record& record, std::size_t i) {  // "k [N/m]"
  const std::string unit = record.answer ? record.answer->unit(i) : "";
  return name_of_unknown(record, i) + (unit.empty() ? "" : fmt::format(" [{}]", unit));
}

// "-0.99 with x3"
TableCell strongest_cell(const Record& record, std::size_t i) {
  const std::vector<Real>& correlations = record.uncertainty->correlation[i];
  std::size_t strongest = i;
  Real most = 0;
  for (std::size_t j = 0; j < correlations.size(); ++j)
    if (j != i && std::abs(correlations[j]) > std::abs(most)) {
      strongest = j;
      most = correlations[j];
    }
  if (strongest == i) return "";
  return {words("uncertainty.strongest", figure(most), name_of_unknown(record, strongest)),
          {{"correlation", most}}};
}

}  // namespace

std::vector<Table> uncertainty_tables(const Comparison& c) {
  std::vector<Table> tables;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    for (const std::size_t s : ranking(c, p)) {
      const Cell& cell = c.cell(p, s);
      if (cell.runs.empty()) continue;
      const Record& record = *c.runs[cell.runs[0]].record;
      const std::optional<Uncertainty>& known = record.uncertainty;
      const bool is_exact = record.minimum == 0.0;  // then the residual is rounding
      if (!known || is_exact || doubt_of(record) != Doubt::none) continue;
      Table table = worded_table("uncertainty", problem_name(c.problems[p]));
      table.id += fmt::format("-{}", p);
      table.topic = {.optimizer = s, .problem = p};
      table.is_folded = true;
      for (std::size_t i = 0; i < known->x.size(); ++i)
        table.rows.push_back({name_with_unit(record, i), number_cell("x", known->x[i]),
                              number_cell("deviation", known->standard_deviation[i]),
                              strongest_cell(record, i)});
      table.reading = words("uncertainty.reading", optimizer_text(c, s), known->variance,
                            known->degrees_of_freedom, known->condition);
      tables.push_back(std::move(table));
      break;
    }
  }
  return tables;
}

}  // namespace isoline::reports
