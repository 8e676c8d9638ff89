// A text from another process: whole, or none and the reason.
#include <gtest/gtest.h>

#include <csignal>

#include "benchmarks/run/isolate.h"
#include "core/clock.h"
#include "tests/benchmarks/hostile.h"

namespace isoline::benchmarks {
namespace {

TEST(IsolatedText, IsTheTextWhole) {
  const std::string large(3 << 20, 'x');
  for (const std::string& text : {std::string(), std::string("whole"), large}) {
    const IsolatedText found = isolated_text([&] { return text; }, 10);
    EXPECT_EQ(found.text, text);
    EXPECT_EQ(found.failure, "");
  }
}

struct BadEnd {
  std::function<std::string()> work;
  double seconds;
  std::string reason;
};

TEST(IsolatedText, OfAProcessThatDoesNotEndWellIsNoneButAReason) {
  const std::vector<BadEnd> ends = {
      {[]() -> std::string { throw std::runtime_error("for a reason"); }, 10, "for a reason"},
      {[]() -> std::string { throw 7; }, 10, "not a std::exception"},
      {[]() -> std::string { throw std::bad_alloc(); }, 10, "memory"},
      {[]() -> std::string { return std::raise(SIGKILL) == 0 ? "x" : "y"; }, 10, "signal 9"},
      {[]() -> std::string { _exit(3); }, 10, "exited with code 3"},
      {[]() -> std::string { _exit(0); }, 10, "without an answer"},
      {[]() -> std::string { std::exit(0); }, 10, "without an answer"},
      {[]() -> std::string {
         std::fprintf(stderr, "the grid is too coarse\n");
         std::abort();
       },
       10, "it last wrote: the grid is too coarse"},
      {[]() -> std::string { throw std::runtime_error("no text: \xff"); }, 10, "no text: \uFFFD"},
      {[]() -> std::string {
         for (;;) pause();
       },
       0.2, "more than 0.2 s"},
      {[]() -> std::string {
         for (volatile bool go_on = true; go_on;) {
         }
         return "";
       },
       0.2, "took more than 0.2 s"}};
  for (const BadEnd& end : ends) {
    const IsolatedText found = isolated_text(end.work, end.seconds);
    EXPECT_FALSE(found.text.has_value()) << end.reason;
    EXPECT_NE(found.failure.find(end.reason), std::string::npos) << found.failure;
  }
}

// As a script that never answers.
TEST(IsolatedText, OfAProcessThatWaitsForAnIdleOneIsGivenUpAsIdle) {
  const IsolatedText found = isolated_text(
      []() -> std::string {
        if (fork() == 0)
          for (;;) pause();
        for (;;) pause();
      },
      0.2);
  EXPECT_NE(found.failure.find("idle for more than"), std::string::npos) << found.failure;
}

TEST(IsolatedText, IsNotWaitedForOnADescendantThatLives) {
  told() = 0;
  const IsolatedText found = isolated_text(
      [] {
        leave_a_daemon_behind();
        return std::string("whole");
      },
      600);
  EXPECT_EQ(found.text, "whole");
  ASSERT_GT(told(), 0);
  EXPECT_NE(kill(told(), 0), 0) << "the daemon lives";
}

TEST(IsolatedText, KeepsWhatTheProcessPrintsFromTheTerminal) {
  testing::internal::CaptureStdout();
  const IsolatedText found = isolated_text(
      [] {
        std::printf("\x1b[31m");
        std::fflush(stdout);
        return std::string("whole");
      },
      10);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(found.text, "whole");
}

}  // namespace
}  // namespace isoline::benchmarks
