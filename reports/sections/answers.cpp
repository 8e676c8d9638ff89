// The x of a run as columns of text.
#include "reports/sections/answers.h"

#include <fmt/format.h>

#include <span>

#include "core/results/uncertainty.h"
#include "reports/sections/words.h"

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
  if (results::doubt_of(record) == results::Doubt::none) {
    const auto intervals = results::intervals_of(record);
    add_numbers("standard deviation", record.uncertainty->standard_deviation);
    const std::string title =
        fmt::format("± t·s (95 %, ν = {})", record.uncertainty->degrees_of_freedom);
    add(title.c_str(), intervals.size(),
        [&](std::size_t i) { return fmt::format("{:.2g}", intervals[i].half); });
  }
  add_numbers("best", answer.point(kBest));
  add("active bound", answer.is_bound_active() ? n : 0,
      [&](std::size_t i) { return answer.bound(i); });
  return columns;
}

std::string doubt_text(const Record& record) {
  const auto test = results::noise_test(record);
  switch (results::doubt_of(record)) {
    case results::Doubt::not_minimum:
      return words("fit.not-minimum", name_of(record.status));
    case results::Doubt::contradicted:
      return words("fit.contradicted", test->chi_square, test->freedom, test->p);
    case results::Doubt::unknown:
      return words("fit.unknown");
    case results::Doubt::none:
      break;
  }
  return "";
}

}  // namespace isoline::reports
