// The flag that signals raise.
#include "benchmarks/merge/ending.h"

namespace isoline::benchmarks {
namespace {

volatile std::sig_atomic_t is_asked = 0;

}  // namespace

EndingGuard::EndingGuard() {
  is_asked = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { is_asked = 1; };
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &action, &old_[i]);
}

EndingGuard::~EndingGuard() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &old_[i], nullptr);
}

void go_on() {
  if (is_asked != 0) throw EndingAsked();
}

}  // namespace isoline::benchmarks
