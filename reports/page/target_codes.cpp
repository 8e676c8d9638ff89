// Writes medians as short texts.
#include "reports/page/target_codes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

std::string alphanumeric(std::uint64_t value) {
  constexpr std::string_view kDigits = "0123456789abcdefghijklmnopqrstuvwxyz";
  std::string text;
  for (; value > 0 || text.empty(); value /= kDigits.size())
    text.insert(text.begin(), kDigits[value % kDigits.size()]);
  return text;
}

// Twice a median of whole numbers is whole.
std::string work_code(Real work) {
  return alphanumeric(static_cast<std::uint64_t>(std::llround(2 * work)));
}

// The very digits that the tables print, as a whole number, and a capital for the power of ten: J
// is 0, I is −1. "0.0931" is 931 and F.
std::string digits_code(const std::string& text) {
  const std::size_t e = std::min(text.find('e'), text.size());
  int power = e < text.size() ? std::stoi(text.substr(e + 1)) : 0;
  std::string digits = text.substr(0, e);
  if (const std::size_t point = digits.find('.'); point != std::string::npos) {
    power -= static_cast<int>(digits.size() - point) - 1;
    digits.erase(point, 1);
  }
  if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) return "";
  return alphanumeric(std::stoull(digits)) + static_cast<char>('J' + std::clamp(power, -9, 9));
}
std::string time_code(Real seconds) { return digits_code(milliseconds(seconds)); }

// Of costs, which are no whole numbers: a digit more than tables print.
std::string cost_code(Real cost) { return digits_code(fmt::format("{:.5g}", cost)); }

auto code_of(Measure by) {
  return by == Measure::time ? time_code : by == Measure::cost ? cost_code : work_code;
}

}  // namespace

std::string target_codes(const std::vector<Real>& medians, Measure by) {
  const auto code = code_of(by);
  std::string text;
  for (std::size_t j = 0; j < medians.size();) {
    const std::string one = code(medians[j]);
    std::size_t count = 1;
    while (j + count < medians.size() && code(medians[j + count]) == one) ++count;
    text += (j > 0 ? "," : "") + one + (count > 1 ? fmt::format("*{}", count) : "");
    j += count;
  }
  return text;
}

}  // namespace isoline::reports
