// The language of the command line and of suites: SPEC := name[key=value,…]. A value may itself be
// a SPEC; commas split only at depth 0; `|` sweeps: sine[xi=1|3|10] is three specs. A value may be
// a JSON string in double quotes, inside which , | [ ] are literal.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/options.h"

namespace isoline {

struct Spec {
  std::string name;
  std::vector<std::pair<std::string, std::string>> options;
};

// A sweep by name, and how many specs it makes.
struct SweepSize {
  std::string name;
  std::uint64_t settings;
};
std::vector<SweepSize> sweep_sizes(std::string_view text);  // counted, not expanded

inline constexpr std::uint64_t kMostSettings = 1'000'000, kMostSeeds = 1'000'000;
inline constexpr std::uint64_t kMostWhereLarge = 1'000'000'000;  // of either, where many are meant

// "a[x=1|2],b" -> a[x=1], a[x=2], b. UsageError, before they are made, where they are more than
// `most`.
std::vector<Spec> parse_specs(std::string_view text, std::uint64_t most = kMostSettings);
Spec parse_spec(std::string_view text);  // UsageError unless it is exactly one

// A text as the value of a spec, in double quotes where it would not come back the same without.
std::string quoted(const std::string& value);

// As texts, by their declared names; UsageError where a name is given twice.
OptionValues options_of(const Spec& spec);

// "sine" of "sine[xi=32]", for labels that do not come from a component. Components, records and
// component files carry their names.
std::string name_of_spec(std::string_view spec);

// "N" -> 0..N-1; "a..b" inclusive; "=5" -> 5; "2:1" -> instance 2 with start 1; commas join.
// UsageError, before they are listed, where they are more than `most`.
std::vector<std::uint64_t> parse_seeds(std::string_view text, std::uint64_t most = kMostSeeds);

// The seeds of each instance with each start; instance 0 or start 0 where its text is empty.
std::vector<std::uint64_t> crossed_seeds(std::string_view instances, std::string_view starts);

inline constexpr double kMostSeconds = 1e9;  // some thirty years: in nanoseconds it still fits

// "10s", "2m", "1.5h", "250ms" or plain seconds.
double parse_duration(std::string_view text);

}  // namespace isoline
