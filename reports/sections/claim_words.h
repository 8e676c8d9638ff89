// A claim in words: what it measures, what was published with which error, and where.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/real.h"

namespace isoline::reports {

// Of a claim, or of its contrast.
std::string quantity_text(
    const nlohmann::json& claim);  // "ratio of the loss, at the end: adam / sip"
std::string published_text(const nlohmann::json& claim);  // "≥ 3 (±5 % from text)"
Real published_value(const nlohmann::json& published);

std::string source_text(const nlohmann::json& source);  // of a claim alone

}  // namespace isoline::reports
