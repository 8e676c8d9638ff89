// JSON whose numbers survive: infinities and NaN are written as the strings "inf", "-inf" and
// "nan". Plain nlohmann-json writes null, which it then fails to read.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/real.h"

namespace isoline {

using Json = nlohmann::json;

Json json_number(Real value);
Json json_numbers(std::span<const Real> values);
Real real_of(const Json& value);  // UsageError if it is not a number
std::vector<Real> reals_of(const Json& list);

// JSON as text. All output uses this function: it replaces invalid UTF-8 by U+FFFD, and never
// throws.
std::string json_text(const Json& value, int indent = -1);

Json parse_json(const std::string& text, const std::string& origin);  // UsageError names the origin
Json read_json(const std::filesystem::path& path);
void write_json(const std::filesystem::path& path, const Json& value);

}  // namespace isoline
