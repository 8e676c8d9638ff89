// Instants as records and sheets write them: whole seconds of universal time,
// "2026-01-31T12:00:00Z".
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace isoline {

// Of seconds since 1970.
std::string instant_text(std::int64_t seconds);
std::optional<std::int64_t> instant_from(const std::string& text);  // none where it is no such text

std::int64_t seconds_now();

}  // namespace isoline
