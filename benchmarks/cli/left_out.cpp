// Files that cannot be read, on the terminal.
#include "benchmarks/cli/left_out.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "benchmarks/cli/terminal.h"
#include "core/text.h"
#include "reports/formats/formats.h"

namespace isoline::benchmarks {

std::size_t say_left_out(const std::vector<results::Unreadable>& unreadable) {
  constexpr std::size_t kMost = 20;
  const std::size_t shown = std::min(unreadable.size(), kMost);
  for (const results::Unreadable& one : std::span(unreadable).first(shown))
    say(stderr, fmt::format("left out: {}: {}\n", reports::terminal_text(one.file),
                            reports::terminal_text(one.reason)));
  if (shown < unreadable.size())
    say(stderr,
        fmt::format("left out: {} more files that cannot be read\n", unreadable.size() - shown));
  return unreadable.size();
}

results::Study study_of(const std::vector<std::string>& folders) {
  results::Study study = results::read_study(folders, progress_on_terminal("reading records"));
  say_left_out(study.unreadable);
  return study;
}

}  // namespace isoline::benchmarks
