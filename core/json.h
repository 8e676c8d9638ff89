// JSON whose numbers survive: infinities and not-a-number are written as the strings "inf", "-inf"
// and "nan", where plain nlohmann-json writes null and then fails to read it.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "core/array.h"

namespace isoline {

using Json = nlohmann::json;

Json json_number(Real value);
Real real_of(const Json& value);  // UsageError when it is no number
Json json_numbers(const Real* values, std::size_t count);

// Text of a file, and whole-or-nothing writing: temporary file, fsync, rename.
std::string read_text(const std::filesystem::path& path);
void write_text(const std::filesystem::path& path, std::string_view text);

Json parse_json(const std::string& text, const std::string& origin);  // UsageError names the origin
Json read_json(const std::filesystem::path& path);
void write_json(const std::filesystem::path& path, const Json& value);

// FNV-1a, 64 bits, as 16 hexadecimal digits: names files by what they hold.
std::string digest(std::string_view text);

}  // namespace isoline
