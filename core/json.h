// JSON whose numbers survive: infinities and not-a-number are written as the strings "inf", "-inf"
// and "nan", where plain nlohmann-json writes null and then fails to read it.
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
Real real_of(const Json& value);  // UsageError when it is no number
std::vector<Real> reals_of(const Json& list);

// The one way of ours to JSON as text: what is no UTF-8 in it becomes U+FFFD, and nothing throws.
std::string json_text(const Json& value, int indent = -1);

Json parse_json(const std::string& text, const std::string& origin);  // UsageError names the origin
Json read_json(const std::filesystem::path& path);
void write_json(const std::filesystem::path& path, const Json& value);

}  // namespace isoline
