// Fields of the best of each kind.
#include "reports/read/found_fields.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

namespace isoline::reports {
namespace {

Real greatest(std::span<const float> values) {
  Real most = 0;
  for (const float value : values) most = std::max(most, std::abs(Real{value}));
  return most;
}

// The time of the last row of these frames, where their rows are states; 0 elsewhere.
Real time_of(const Sheet* sheet, const FieldFrames& frames) {
  const bool is_of_sheet =
      sheet != nullptr && sheet->field && sheet->field->rows == frames.shape[1];
  return is_of_sheet ? sheet->field->time : 0;
}

// The row of x only: the first one of a history.
std::vector<Real> distances(const FieldFrames& frames, bool is_history) {
  std::vector<Real> apart;
  if (!frames.has_truth()) return apart;
  const Index rows = is_history ? 1 : frames.shape[1];
  const auto cells = static_cast<std::size_t>(rows * frames.shape[2]);
  const std::span<const float> truth = frames.truth();
  for (std::size_t i = 0; i < frames.iterations.size(); ++i) {
    Real rest = 0, whole = 0;
    for (std::size_t k = 0; k < cells; ++k) {
      rest += std::pow(Real{frames.x(i)[k]} - Real{truth[k]}, 2);
      whole += std::pow(Real{truth[k]}, 2);
    }
    apart.push_back(std::sqrt(rest) / std::sqrt(whole));
  }
  return apart;
}

// The same cells, with a known x* in both or neither.
bool is_alike(const FieldFrames& a, const FieldFrames& b) {
  return a.shape[1] == b.shape[1] && a.shape[2] == b.shape[2] && a.has_truth() == b.has_truth();
}

// From the least seed that keeps them, or from this seed if requested.
std::optional<FoundField> field_of(const Comparison& c, std::size_t p, std::size_t s,
                                   std::optional<std::uint64_t>& seed) {
  std::vector<const Record*> records;
  for (const std::size_t run : c.cell(p, s).runs) records.push_back(c.runs[run].record);
  std::ranges::sort(records, {}, [](const Record* record) { return record->request.seed; });
  for (const Record* record : records) {
    if (seed && record->request.seed != *seed) continue;
    std::optional<FieldFrames> frames = c.study->fields_of(*record);
    if (!frames) continue;
    seed = record->request.seed;
    std::vector<Real> apart = distances(*frames, time_of(c.problems[p].sheet, *frames) > 0);
    return FoundField{s, std::move(*frames), std::move(apart)};
  }
  return std::nullopt;
}

}  // namespace

std::optional<FoundFields> found_fields(const Comparison& c, std::size_t p) {
  std::set<std::string> kinds;
  std::optional<std::uint64_t> seed;
  FoundFields out;
  for (const std::size_t s : ranking(c, p)) {
    const std::string kind = c.optimizers[s].mathematics();
    if (kinds.contains(kind)) continue;
    std::optional<FoundField> found = field_of(c, p, s, seed);
    if (!found || (!out.found.empty() && !is_alike(found->frames, out.frames()))) continue;
    kinds.insert(kind);
    out.found.push_back(std::move(*found));
  }
  if (out.found.empty()) return std::nullopt;
  const FieldFrames& first = out.frames();
  const Sheet* sheet = c.problems[p].sheet;
  const bool is_named = sheet != nullptr && sheet->field.has_value();
  out.x = is_named ? sheet->field->x : Quantity{"x"};
  out.y = is_named ? sheet->field->y : Quantity{"y"};
  out.seed = *seed;
  out.is_learned = c.problems[p].is_learned;
  out.x_scale = greatest(first.has_truth() ? first.truth() : first.x(first.iterations.size() - 1));
  out.time = time_of(sheet, first);
  out.y_scale = out.is_history() ? out.x_scale : greatest(first.target());
  return out;
}

AllFields all_found_fields(const Comparison& c) {
  AllFields all;
  for (std::size_t p = 0; p < c.problems.size(); ++p) all.push_back(found_fields(c, p));
  return all;
}

}  // namespace isoline::reports
