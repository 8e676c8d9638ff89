// The x of a run as columns of text.
#include "reports/sections/answers.h"

#include <fmt/format.h>

#include <span>

namespace isoline::reports {

std::vector<AnswerColumn> answer_columns(const Record& record, const AnswerPoints& answer,
                                         const char* number_format) {
  std::vector<AnswerColumn> columns;
  const auto add = [&](const char* name, std::size_t count, auto text) {
    if (count == 0) return;
    columns.push_back({name, {}});
    for (std::size_t i = 0; i < count; ++i) columns.back().texts.emplace_back(text(i));
  };
  const auto add_numbers = [&](const char* name, std::span<const Real> values) {
    add(name, values.size(),
        [&](std::size_t i) { return fmt::format(fmt::runtime(number_format), values[i]); });
  };
  const auto n = static_cast<std::size_t>(answer.unknowns);
  add("unknown", n, [&](std::size_t i) { return answer.name(i); });
  add("unit", answer.units.size(), [&](std::size_t i) { return answer.unit(i); });
  add_numbers("returned", answer.point(kReturned));
  if (record.uncertainty) add_numbers("standard deviation", record.uncertainty->standard_deviation);
  add_numbers("best", answer.point(kBest));
  add("active bound", answer.is_bound_active() ? n : 0,
      [&](std::size_t i) { return answer.bound(i); });
  return columns;
}

}  // namespace isoline::reports
