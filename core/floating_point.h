// The floating-point environment of this process, put back when a scope ends. Code of others may
// change it: a library that was built with -Ofast lets subnormal numbers be zero once it is loaded.
#pragma once

#include <cfenv>

namespace isoline {

class KeptFloatingPoint {
 public:
  KeptFloatingPoint() { std::fegetenv(&before_); }
  ~KeptFloatingPoint() { std::fesetenv(&before_); }
  KeptFloatingPoint(const KeptFloatingPoint&) = delete;
  KeptFloatingPoint& operator=(const KeptFloatingPoint&) = delete;

 private:
  std::fenv_t before_;
};

}  // namespace isoline
