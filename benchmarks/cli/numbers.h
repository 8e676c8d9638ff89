// Numbers of a command line, each held to its law: one sentence states the law and what was given.
// An option that must never be read as another number than the one that was typed is read here.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "core/options.h"
#include "core/text.h"

namespace isoline::benchmarks {

struct WholeLaw {
  std::int64_t low = 1, high = kMostAmount;
};

// UsageError where the text is no number, or none that the law allows. `option` opens the sentence.
std::int64_t read_whole(const std::string& option, const std::string& text, WholeLaw law);
std::uint64_t read_seed(const std::string& option, const std::string& text);
double read_real(const std::string& option, const std::string& text, const Range& range);

double read_time(const std::string& option, const std::string& text);  // seconds, of "2m"

// "2GB", "1.5GiB" or bytes; a unit is 1024 of the one before. Less than 16MB starts no cell.
std::int64_t read_bytes(const std::string& option, const std::string& text);

}  // namespace isoline::benchmarks
