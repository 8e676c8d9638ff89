// The live line of verbs that read many files.
#include <unistd.h>

#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/progress.h"

namespace isoline::benchmarks {

Listener on_terminal(const char* what) {
  if (Progress::style_of(STDERR_FILENO) != Progress::Style::live) return {};
  return [what, line = std::shared_ptr<Progress>()](std::size_t done, std::size_t all) mutable {
    if (line == nullptr)
      line = std::make_shared<Progress>(Progress::Style::live, what, std::int64_t(all), 0);
    line->reached(std::int64_t(done));
    line->show();
  };
}

}  // namespace isoline::benchmarks
