// Finds grids by what all their runs share.
#include "reports/read/sweeps.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/errors.h"
#include "core/learning_options.h"
#include "core/spec.h"

namespace isoline::reports {
namespace {

// One option of a run, or of a component inside another.
struct Feature {
  std::string text;
  std::optional<Real> number;
};
using Features = std::map<std::string, Feature>;

std::optional<Real> number_of(const OptionValue& value) {
  if (const Real* real = std::get_if<Real>(&value)) return *real;
  if (const Index* whole = std::get_if<Index>(&value)) return static_cast<Real>(*whole);
  return std::nullopt;
}

std::optional<Real> number_of(const std::string& text) {
  char* end = nullptr;
  const Real value = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0' ? std::optional(value) : std::nullopt;
}

// "network-optimizer" is a name and "network-optimizer.rate" a number of "adam[rate=1e-3]".
void add_inner(const std::string& name, const std::string& text, Features& out) {
  out[name] = {name_of_spec(text), std::nullopt};
  if (out[name].text == text) return;
  try {
    for (const auto& [option, value] : parse_spec(text).options)
      out[fmt::format("{}.{}", name, option)] = {value, number_of(value)};
  } catch (const UsageError&) {
    out[name] = {text, std::nullopt};  // a text of another kind
  }
}

void add(const Component& component, Features& out) {
  for (const NamedOption& option : component.options) {
    if (const std::string* text = std::get_if<std::string>(&option.value))
      add_inner(option.name, *text, out);
    else
      out[option.name] = {option_text(option.value), number_of(option.value)};
  }
}

struct Entry {
  std::size_t run;
  Features features;
  std::int64_t iterations, samples;  // allowed
};
using Entries = std::vector<Entry>;

// By problem and optimizer.
std::map<std::pair<std::string, std::string>, Entries> entries_of(const Comparison& c) {
  std::map<std::pair<std::string, std::string>, Entries> all;
  for (std::size_t i = 0; i < c.runs.size(); ++i) {
    const Request& request = c.runs[i].record->request;
    if (c.runs[i].is_repeated || c.runs[i].record->status == Status::inapplicable) continue;
    Entry entry{i, {}, request.budget.iterations, 0};
    add(request.problem, entry.features);
    add(request.optimizer, entry.features);
    const auto batch = static_cast<std::int64_t>(request.problem.options.number(kBatchOption, 1));
    entry.samples = batch > 0 && entry.iterations < Budget{}.iterations ? entry.iterations * batch
                                                                        : entry.iterations;
    all[{request.problem.name, request.optimizer.name}].push_back(std::move(entry));
  }
  return all;
}

std::vector<std::string> swept_options(const Entries& entries) {
  std::map<std::string, std::set<Real>> values;
  for (const Entry& entry : entries)
    for (const auto& [name, feature] : entry.features)
      if (feature.number) values[name].insert(*feature.number);
  std::vector<std::string> names;
  for (const auto& [name, each] : values)
    if (each.size() > 1) names.push_back(name);
  return names;
}

struct Pair {
  std::string first, second;
  bool by_samples;  // what runs share is the number of samples, instead of iterations
};

// All that two runs of one grid share; empty where the run has not both options.
std::string key_of(const Entry& entry, const Pair& pair) {
  const auto has = [&](const std::string& name) {
    const auto at = entry.features.find(name);
    return at != entry.features.end() && at->second.number;
  };
  if (!has(pair.first) || !has(pair.second)) return "";
  std::string key = std::to_string(pair.by_samples ? entry.samples : entry.iterations);
  for (const auto& [name, feature] : entry.features)
    if (name != pair.first && name != pair.second) key += fmt::format(",{}={}", name, feature.text);
  return key;
}

SweepGrid grid_of(const std::vector<const Entry*>& entries, const Pair& pair) {
  SweepGrid grid{.row = pair.first, .column = pair.second};
  const auto values = [&](const std::string& name) {
    std::set<Real> all;
    for (const Entry* entry : entries) all.insert(*entry->features.at(name).number);
    return std::vector<Real>(all.begin(), all.end());
  };
  grid.rows = values(grid.row);
  grid.columns = values(grid.column);
  if (grid.rows.size() > grid.columns.size()) {
    std::swap(grid.row, grid.column);
    std::swap(grid.rows, grid.columns);
  }
  grid.runs.assign(grid.rows.size(), std::vector<std::vector<std::size_t>>(grid.columns.size()));
  const auto place = [](const std::vector<Real>& all, Real value) {
    return static_cast<std::size_t>(std::ranges::lower_bound(all, value) - all.begin());
  };
  for (const Entry* entry : entries)
    grid.runs[place(grid.rows, *entry->features.at(grid.row).number)]
             [place(grid.columns, *entry->features.at(grid.column).number)]
                 .push_back(entry->run);
  (pair.by_samples ? grid.samples : grid.iterations) =
      pair.by_samples ? entries[0]->samples : entries[0]->iterations;
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

void add_grids(const Entries& entries, const Pair& pair, std::vector<SweepGrid>& out) {
  std::map<std::string, std::vector<const Entry*>> groups;
  for (const Entry& entry : entries) {
    const std::string key = key_of(entry, pair);
    if (!key.empty()) groups[key].push_back(&entry);
  }
  for (const auto& [key, group] : groups)
    if (SweepGrid grid = grid_of(group, pair); is_full_enough(grid)) out.push_back(std::move(grid));
}

}  // namespace

std::vector<SweepGrid> sweep_grids(const Comparison& c) {
  std::vector<SweepGrid> all;
  for (const auto& [names, entries] : entries_of(c)) {
    const std::vector<std::string> options = swept_options(entries);
    std::vector<SweepGrid> own;
    for (std::size_t a = 0; a < options.size(); ++a)
      for (std::size_t b = a + 1; b < options.size(); ++b) {
        const bool has_batches = options[a] == kBatchOption || options[b] == kBatchOption;
        for (const bool by_samples : {false, true})
          if (has_batches || !by_samples)
            add_grids(entries, {options[a], options[b], by_samples}, own);
      }
    for (SweepGrid& grid : own) {
      std::tie(grid.problem, grid.optimizer) = names;
      all.push_back(std::move(grid));
    }
  }
  std::ranges::stable_sort(all, std::greater(), cells_of);
  return all;
}

}  // namespace isoline::reports
