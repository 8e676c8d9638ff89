// What every verb tells the shell that called it.
#pragma once

namespace isoline {

enum ExitCode {
  kGood = 0,
  kUsage = 1,          // the caller's mistake
  kWorse = 2,          // than before; or cells failed
  kBetterOnly = 3,     // than before, in something, and nowhere worse
  kNotComparable = 4,  // at least in part
  kInterrupted = 130   // what a shell expects after Ctrl-C
};

}  // namespace isoline
