// A curve that others computed, read from CSV by its description.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "benchmarks/import/curve_description.h"

namespace isoline::benchmarks {

// One point a row. Where no column tells iterations they are counted from 0; times that are not
// told are infinite, errors and norms not a number.
struct ForeignCurve {
  std::vector<std::int64_t> iteration, work;
  std::map<std::string, std::vector<std::int64_t>> counts;  // by oracle, of those that are told
  std::vector<Real> wall_seconds, processor_seconds, loss, x_error, gradient_norm, step_norm;

  std::size_t points() const { return loss.size(); }
};

// UsageError, which names the line, where a row has another length than the first, a field is not
// the number that its column must hold, or what can only grow does not.
ForeignCurve curve_from_text(const std::string& text, const std::string& origin,
                             const CurveDescription& told);

}  // namespace isoline::benchmarks
