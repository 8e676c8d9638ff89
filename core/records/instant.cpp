// Instants to text and back, whatever the time zone and the locale of the machine.
#include "core/records/instant.h"

#include <fmt/format.h>

#include <chrono>
#include <ctime>

namespace isoline {

std::string instant_text(std::int64_t seconds) {
  const std::time_t time = seconds;
  std::tm parts{};
  gmtime_r(&time, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", parts.tm_year + 1900, parts.tm_mon + 1,
                     parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec);
}

// What is written otherwise, as a 31st of February, is no instant: it would come back as another.
std::optional<std::int64_t> instant_from(const std::string& text) {
  std::tm parts{};
  const char* end = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  if (end == nullptr || end != text.data() + text.size()) return std::nullopt;
  const std::int64_t seconds = timegm(&parts);
  if (instant_text(seconds) != text) return std::nullopt;
  return seconds;
}

std::int64_t seconds_now() {
  return std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
}

}  // namespace isoline
