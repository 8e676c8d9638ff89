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

Real distance(std::span<const float> a, std::span<const float> b) {
  Real sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(Real{a[i]} - Real{b[i]}, 2);
  return std::sqrt(sum);
}

std::vector<Real> distances(const FieldFrames& frames) {
  std::vector<Real> apart;
  if (!frames.has_truth()) return apart;
  const std::vector<float> nothing(frames.truth().size(), 0);
  for (std::size_t i = 0; i < frames.iterations.size(); ++i)
    apart.push_back(distance(frames.x(i), frames.truth()) / distance(nothing, frames.truth()));
  return apart;
}

// Of the same cells, of which x* is known of both or of none.
bool is_alike(const FieldFrames& a, const FieldFrames& b) {
  return a.shape[1] == b.shape[1] && a.shape[2] == b.shape[2] && a.has_truth() == b.has_truth();
}

// Of the least seed that keeps them; of this seed where one is wanted.
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
    std::vector<Real> apart = distances(*frames);
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
  out.y_scale = greatest(first.target());
  return out;
}

AllFields all_found_fields(const Comparison& c) {
  AllFields all;
  for (std::size_t p = 0; p < c.problems.size(); ++p) all.push_back(found_fields(c, p));
  return all;
}

}  // namespace isoline::reports
