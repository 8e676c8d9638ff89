// Finds grids by what all their runs share.
#include "reports/read/sweeps.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/errors.h"
#include "core/options.h"
#include "core/spec.h"

namespace isoline::reports {
namespace {

// Options of a run, and of components inside it, as texts; those that are numbers.
struct Entry {
  std::size_t run;
  std::int64_t iterations, samples;  // allowed
  std::map<std::string, std::string> texts = {};
  std::map<std::string, Real> numbers = {};

  void add(const std::string& name, const std::string& text) {
    texts[name] = text;
    char* end = nullptr;
    const Real value = std::strtod(text.c_str(), &end);
    if (!text.empty() && *end == '\0') numbers[name] = value;
  }
};
using Entries = std::vector<Entry>;

// "network-optimizer" is a name and "network-optimizer.rate" a number of "adam[rate=1e-3]".
void add_inner(const std::string& name, const std::string& text, Entry& out) {
  out.texts[name] = text;
  if (name_of_spec(text) == text) return;
  try {
    for (const auto& [option, value] : parse_spec(text).options)
      out.add(name + "." + option, value);
    out.texts[name] = name_of_spec(text);
  } catch (const UsageError&) {  // a text of another kind
  }
}

void add(const Component& component, Entry& out) {
  for (const NamedOption& option : component.options) {
    const std::string* text = std::get_if<std::string>(&option.value);
    if (text != nullptr) {
      add_inner(option.name, *text, out);
      continue;
    }
    out.texts[option.name] = option_text(option.value);
    if (const Real* real = std::get_if<Real>(&option.value)) out.numbers[option.name] = *real;
    if (const Index* whole = std::get_if<Index>(&option.value))
      out.numbers[option.name] = static_cast<Real>(*whole);
  }
}

// By problem and optimizer.
std::map<std::pair<std::string, std::string>, Entries> entries_of(const Comparison& c) {
  std::map<std::pair<std::string, std::string>, Entries> all;
  for (std::size_t i = 0; i < c.runs.size(); ++i) {
    const Request& request = c.runs[i].record->request;
    if (c.runs[i].is_repeated || c.runs[i].record->status == Status::inapplicable) continue;
    const std::int64_t iterations = request.budget.iterations;
    const auto batch = static_cast<std::int64_t>(request.problem.options.number(kBatchOption, 1));
    const bool is_counted = batch > 0 && iterations < Budget{}.iterations;
    Entry entry{i, iterations, is_counted ? iterations * batch : iterations};
    add(request.problem, entry);
    add(request.optimizer, entry);
    all[{request.problem.name, request.optimizer.name}].push_back(std::move(entry));
  }
  return all;
}

std::vector<std::string> swept_options(const Entries& entries) {
  std::map<std::string, std::set<Real>> values;
  for (const Entry& entry : entries)
    for (const auto& [name, number] : entry.numbers) values[name].insert(number);
  std::vector<std::string> names;
  for (const auto& [name, each] : values)
    if (each.size() > 1) names.push_back(name);
  return names;
}

SweepGrid grid_of(const std::vector<const Entry*>& entries, std::string row, std::string column) {
  const auto values = [&](const std::string& name) {
    std::set<Real> all;
    for (const Entry* entry : entries) all.insert(entry->numbers.at(name));
    return std::vector<Real>(all.begin(), all.end());
  };
  if (values(row).size() > values(column).size()) std::swap(row, column);
  SweepGrid grid{.row = row, .column = column, .rows = values(row), .columns = values(column)};
  grid.runs.assign(grid.rows.size(), std::vector<std::vector<std::size_t>>(grid.columns.size()));
  const auto place = [](const std::vector<Real>& all, Real value) {
    return static_cast<std::size_t>(std::ranges::lower_bound(all, value) - all.begin());
  };
  for (const Entry* entry : entries)
    grid.runs[place(grid.rows, entry->numbers.at(row))]
             [place(grid.columns, entry->numbers.at(column))]
                 .push_back(entry->run);
  return grid;
}

std::size_t cells_of(const SweepGrid& grid) { return grid.rows.size() * grid.columns.size(); }

bool is_full_enough(const SweepGrid& grid) {
  constexpr std::size_t kRows = 2, kColumns = 3;
  std::size_t filled = 0;
  for (const auto& row : grid.runs)
    for (const auto& cell : row) filled += !cell.empty();
  return grid.rows.size() >= kRows && grid.columns.size() >= kColumns &&
         4 * filled >= 3 * cells_of(grid);
}

// Groups of runs that share all but two options, and their length: in iterations, or in samples.
void add_grids(const Entries& entries, const std::string& first, const std::string& second,
               bool is_by_samples, std::vector<SweepGrid>& out) {
  std::map<std::string, std::vector<const Entry*>> groups;
  for (const Entry& entry : entries) {
    if (!entry.numbers.contains(first) || !entry.numbers.contains(second)) continue;
    std::string key = std::to_string(is_by_samples ? entry.samples : entry.iterations);
    for (const auto& [name, text] : entry.texts)
      if (name != first && name != second) key += fmt::format(",{}={}", name, text);
    groups[key].push_back(&entry);
  }
  for (const auto& [key, group] : groups) {
    SweepGrid grid = grid_of(group, first, second);
    (is_by_samples ? grid.samples : grid.iterations) =
        is_by_samples ? group[0]->samples : group[0]->iterations;
    if (is_full_enough(grid)) out.push_back(std::move(grid));
  }
}

}  // namespace

std::vector<SweepGrid> sweep_grids(const Comparison& c) {
  std::vector<SweepGrid> all;
  for (const auto& [names, entries] : entries_of(c)) {
    const std::vector<std::string> options = swept_options(entries);
    const std::size_t before = all.size();
    for (std::size_t a = 0; a < options.size(); ++a)
      for (std::size_t b = a + 1; b < options.size(); ++b) {
        add_grids(entries, options[a], options[b], false, all);
        if (options[a] == kBatchOption || options[b] == kBatchOption)
          add_grids(entries, options[a], options[b], true, all);
      }
    for (std::size_t i = before; i < all.size(); ++i)
      std::tie(all[i].problem, all[i].optimizer) = names;
  }
  std::ranges::stable_sort(all, std::greater(), cells_of);
  return all;
}

}  // namespace isoline::reports
