// A text made in a process of its own: sheets, audits, checks of what may crash.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "benchmarks/run/limits.h"

namespace isoline::benchmarks {

// What work in a child process came to: its text, or why there is none.
struct IsolatedText {
  std::optional<std::string> text;
  std::string failure;  // "it threw: …", "it was ended by signal 11 (Segmentation fault)", …
};

// Ended after so many seconds of processor time, or of idleness, or five times as many in all.
IsolatedText isolated_text(const std::function<std::string()>& work, double seconds,
                           std::int64_t memory_bytes = Limits{}.memory_bytes);

}  // namespace isoline::benchmarks
