// The x of a run, as the verb `solution` and the page show it.
#pragma once

#include <string>
#include <vector>

#include "core/records/record.h"

namespace isoline::reports {

// The x of a run as columns: "unknown", then those of "unit", "returned", "standard deviation", its
// multiple of t, "best" and "active bound" that it has.
struct AnswerColumn {
  std::string name;
  std::vector<std::string> texts;  // (unknowns)
};
std::vector<AnswerColumn> answer_columns(const Record& record, const AnswerPoints& answer,
                                         const char* number_format);

// The reason why it has no standard deviations, as a sentence; empty where it has them.
std::string doubt_text(const Record& record);

}  // namespace isoline::reports
