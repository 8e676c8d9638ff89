// Curves of others: the description, a zero byte, the CSV file.
#include "benchmarks/import/foreign_curve.h"

#include <stdexcept>

#include "tests/fuzz/targets.h"

namespace isoline::fuzz {

using benchmarks::curve_from_text;
using benchmarks::CurveDescription;
using benchmarks::description_from_text;
using benchmarks::ForeignCurve;

void foreign_curve(std::string_view bytes) {
  const std::size_t end = bytes.find('\0');
  expect_read_or_refused([&] {
    const CurveDescription told =
        description_from_text(std::string(bytes.substr(0, end)), "curve.json");
    if (end == std::string_view::npos) return;
    const ForeignCurve curve =
        curve_from_text(std::string(bytes.substr(end + 1)), "curve.csv", told);
    for (const std::size_t size : {curve.iteration.size(), curve.work.size(), curve.x_error.size(),
                                   curve.wall_seconds.size(), curve.step_norm.size()})
      if (size != curve.points() || size == 0)
        throw std::logic_error("columns of a curve that differ in length");
  });
}

}  // namespace isoline::fuzz
