// A claim in words: what it measures, what was published with which error, and where.
#pragma once

#include <string>

#include "core/records/record.h"

namespace isoline::reports {

// Of a claim, or of its contrast.
std::string quantity_text(const Json& claim);   // "ratio of the loss, at the end: adam / sip"
std::string published_text(const Json& claim);  // "≥ 3 (±5 % from text)"
Real published_value(const Json& published);

std::string source_text(const Json& source);  // of a claim alone

}  // namespace isoline::reports
