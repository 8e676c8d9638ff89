// The processor time of a program that computes for this one counts as this one's.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <ctime>

#include "core/clock.h"
#include "core/foreign/child.h"
#include "core/shell.h"

namespace isoline {
namespace {

// Beside that of this process itself.
double counted_beside() {
  timespec own{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &own);
  return processor_seconds() - static_cast<double>(own.tv_sec) -
         1e-9 * static_cast<double>(own.tv_nsec);
}

TEST(CountedProcess, ItsTimeIsThatOfWhomItComputesForAndStaysWhenItHasGone) {
  constexpr double kEnough = 0.05;  // seconds, much more than two clocks read in turn differ by
  const double before = counted_beside();
  double counted = 0;
  {
    const ChildProgram busy({.command = "sh -c 'while :; do :; done'"});
    for (int look = 0; look < 6000 && counted < kEnough; ++look) {
      poll(nullptr, 0, 5);
      counted = counted_beside() - before;
    }
    EXPECT_GE(counted, kEnough);
  }
  EXPECT_GE(counted_beside() - before, 0.9 * counted);
  const pid_t forked = fork();  // who counts nobody itself
  if (forked == 0) _exit(counted_beside() < 0.9 * kEnough ? 0 : 1);
  int status = 1;
  waitpid(forked, &status, 0);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace isoline
