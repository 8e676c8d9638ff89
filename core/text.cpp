// Decodes UTF-8 by table 3-7 of the Unicode standard, which excludes overlong forms, surrogates and
// code points above U+10FFFF.
#include "core/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <numeric>
#include <system_error>
#include <utility>

#include "core/columns.h"

namespace isoline {
namespace {

constexpr std::string_view kReplacement = "\uFFFD";

struct Character {
  char32_t code = 0;
  std::size_t bytes = 1;  // of a broken one: those that begin none that could be whole
  bool is_valid = true;
};

std::size_t bytes_after(unsigned char lead) {
  if (lead >= 0xC2 && lead <= 0xDF) return 1;
  if (lead >= 0xE0 && lead <= 0xEF) return 2;
  if (lead >= 0xF0 && lead <= 0xF4) return 3;
  return 0;
}

Character first_of(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return {.code = lead};
  const std::size_t rest = bytes_after(lead);
  unsigned low = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  unsigned high = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  char32_t code = lead & (0x3FU >> rest);
  for (std::size_t i = 1; i <= rest; ++i) {
    const bool is_next = i < text.size() && byte(i) >= low && byte(i) <= high;
    if (!is_next) return {.bytes = i, .is_valid = false};
    code = code << 6 | (byte(i) & 0x3FU);
    low = 0x80;
    high = 0xBF;
  }
  return {.code = code, .bytes = rest + 1, .is_valid = rest > 0};
}

// Calls visit(character, its bytes) from the first to the last.
template <class Visit>
void for_each_character(std::string_view text, Visit visit) {
  while (!text.empty()) {
    const Character character = first_of(text);
    visit(character, text.substr(0, character.bytes));
    text.remove_prefix(character.bytes);
  }
}

// Control characters of both sets, the marks that turn the direction of writing, and the line ends
// that are none of a file's.
bool is_harmful(char32_t code) {
  if (code == '\n' || code == '\t') return false;
  const auto is_within = [&](char32_t first, char32_t last) {
    return code >= first && code <= last;
  };
  return code < 0x20 || is_within(0x7F, 0x9F) || code == 0x061C || is_within(0x200E, 0x200F) ||
         is_within(0x2028, 0x202E) || is_within(0x2066, 0x2069);
}

// Levenshtein (1966): least number of letters inserted, deleted or replaced.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string valid_utf8(std::string_view text) {
  std::string valid;
  valid.reserve(text.size());
  for_each_character(text, [&](const Character& character, std::string_view bytes) {
    valid += character.is_valid ? bytes : kReplacement;
  });
  return valid;
}

std::string_view cut(std::string_view text, std::size_t most_bytes) {
  if (text.size() <= most_bytes) return text;
  constexpr std::size_t kLongest = 4;
  std::size_t end = most_bytes;
  const auto is_inside = [&] { return (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U; };
  while (end > 0 && most_bytes - end < kLongest && is_inside()) --end;
  return text.substr(
      0, is_inside() ? most_bytes : end);  // inside an invalid sequence it is cut anywhere
}

std::string printable(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  for_each_character(text, [&](const Character& character, std::string_view bytes) {
    if (!character.is_valid)
      shown += kReplacement;
    else if (is_harmful(character.code))
      shown += fmt::format("\\u{:04x}", static_cast<unsigned>(character.code));
    else
      shown += bytes;
  });
  return shown;
}

void say(std::FILE* out, std::string_view text) {
  constexpr std::size_t kFewest = 60;  // columns
  std::string shown = printable(text);
  if (isatty(fileno(out)) != 0)
    shown = fitted_text(shown, std::max(kFewest, terminal_width(fileno(out))));
  if (std::fwrite(shown.data(), 1, shown.size(), out) < shown.size())
    throw std::system_error(errno, std::generic_category(), "cannot write the output");
}

// Counts as they are read: in groups of three digits.

std::string count_text(std::uint64_t count) {
  if (count == kUncountable) return "more than 10^19";
  std::string text = std::to_string(count);
  constexpr std::size_t kGroup = 3;
  for (std::size_t at = text.size(); at > kGroup; at -= kGroup) text.insert(at - kGroup, ",");
  return text;
}

// Edit distance, and the sentence about an unknown name.

std::string nearest_name(std::string_view wrong, const std::vector<std::string>& known) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, wrong.size() / 3) + 1;
  for (const std::string& name : known) {
    const bool begins = wrong.size() >= 2 && name.starts_with(wrong);
    const std::size_t distance = begins ? 1 : edit_distance(wrong, name);
    if (distance > 1 && !name.starts_with(wrong.substr(0, 1))) continue;  // 'report' for 'import'
    if (distance < least) {
      least = distance;
      nearest = name;
    }
  }
  return nearest;
}

namespace {

// Names of which it is a part between hyphens, or of which it begins the initials: "lm" of ceres-lm
// and levenberg-marquardt.
std::vector<std::string> names_by_part(std::string_view wrong,
                                       const std::vector<std::string>& known) {
  constexpr std::size_t kFew = 5;
  std::vector<std::string> meant;
  for (const std::string& name : known) {
    std::string initials, part;
    bool is_part = false;
    for (const char letter : name + "-") {
      if (letter != '-') {
        part += letter;
        continue;
      }
      is_part = is_part || part == wrong;
      initials += part.substr(0, 1);
      part.clear();
    }
    if (is_part || (wrong.size() > 1 && initials.starts_with(wrong))) meant.push_back(name);
  }
  if (meant.size() > kFew) meant.clear();
  return meant;
}

}  // namespace

std::string unknown_name(std::string_view what, std::string_view wrong,
                         const std::vector<std::string>& known) {
  if ((what == "problem" || what == "optimizer") && wrong.find_first_of(" ./") != wrong.npos)
    return fmt::format("unknown {} '{}'; a script is process[command=\"python3 mine.py\"]", what,
                       wrong);
  const std::string nearest = nearest_name(wrong, known);
  if (!nearest.empty())
    return fmt::format("unknown {} '{}'; did you mean '{}'?", what, wrong, nearest);
  if (const std::vector<std::string> meant = names_by_part(wrong, known); !meant.empty())
    return fmt::format("unknown {} '{}'; did you mean '{}'?", what, wrong,
                       fmt::join(meant, "' or '"));
  constexpr std::size_t kMostListed = 30;
  if (known.size() > kMostListed)
    return fmt::format("unknown {} '{}'; `isoline describe` prints the {} known names", what, wrong,
                       known.size());
  return fmt::format("unknown {} '{}'; known: {}", what, wrong, fmt::join(known, ", "));
}

}  // namespace isoline
