// The log of calls: replayed bit for bit, cut off where it is damaged or where the run differs.
#include "core/foreign/call_log.h"

#include <gtest/gtest.h>

#include <array>

#include "core/files.h"
#include "tests/temporary_folder.h"

namespace isoline {
namespace {

class Calls : public testing::Test {
 protected:
  struct Answer {
    std::optional<std::string> why;
    std::array<Real, 2> y;
  };
  CallLog log(bool is_forced = true) const { return {path, "a run", is_forced}; }
  static Answer replay(CallLog& log, Real x, Verb verb = Verb::linearize) {
    Answer answer{{}, {0, 0}};
    const std::span<const Real> request(&x, 1);
    answer.why = log.replay(verb, 0, std::span(&request, 1), answer.y);
    return answer;
  }
  static void append(CallLog& log, Real x, const std::string& why = "", double seconds = 0) {
    const std::array<Real, 2> y = {2 * x, -x};
    const std::span<const Real> request(&x, 1);
    log.append(Verb::linearize, 0, std::span(&request, 1), y, why, seconds);
  }
  void write_three(double seconds = 0) const {
    CallLog first = log();
    append(first, 1, "", seconds);
    append(first, 2, "no mesh");
    append(first, 3);
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "checkpoints/run.calls";
};

TEST_F(Calls, AreAnsweredAndThenContinued) {
  write_three();
  {
    CallLog second = log();
    const Answer one = replay(second, 1);
    EXPECT_EQ(one.why, "");
    EXPECT_EQ(one.y, (std::array<Real, 2>{2, -1}));
    EXPECT_EQ(replay(second, 2).why, "no mesh");
    EXPECT_EQ(replay(second, 3).why, "");
    EXPECT_FALSE(replay(second, 4).why) << "there are only three";
    append(second, 4);
  }
  CallLog third = log();
  for (const Real x : {1, 2, 3, 4}) EXPECT_TRUE(replay(third, x).why) << x;
}

TEST_F(Calls, OfAnotherRunAreNotAnswers) {
  write_three();
  {
    CallLog other = log();
    EXPECT_TRUE(replay(other, 1).why);
    EXPECT_FALSE(replay(other, 2.5).why);
    append(other, 2.5);
  }
  CallLog again = log();
  EXPECT_TRUE(replay(again, 1).why);
  EXPECT_TRUE(replay(again, 2.5).why);
  EXPECT_FALSE(replay(again, 3).why) << "it was cut off";
  CallLog stranger(path, "another run", false);
  EXPECT_FALSE(replay(stranger, 1).why);
}

TEST_F(Calls, OfADamagedTailAreCutOff) {
  write_three();
  const std::string whole = read_text(path);
  for (const std::size_t lost : {1U, 8U, 40U}) {
    write_text(path, whole.substr(0, whole.size() - lost));
    {
      CallLog damaged = log();
      EXPECT_TRUE(replay(damaged, 1).why && replay(damaged, 2).why);
      testing::internal::CaptureStderr();
      EXPECT_FALSE(replay(damaged, 3).why) << lost;
      const std::string said = testing::internal::GetCapturedStderr();
      EXPECT_NE(said.find("after 2 calls"), said.npos) << said;
      append(damaged, 3);
    }
    EXPECT_EQ(read_text(path), whole) << lost;
  }
  std::string changed = whole;
  changed[changed.size() - 3] ^= 1;
  write_text(path, changed);
  CallLog damaged = log();
  EXPECT_TRUE(replay(damaged, 1).why && replay(damaged, 2).why);
  EXPECT_FALSE(replay(damaged, 3).why);
}

// Of a slow problem: a judge, or the measurement of a cost, asks for some of them.
TEST_F(Calls, AreAnsweredInAnyOrderWhereTheFirstWasSlow) {
  write_three(0.5);
  const auto look = [&] { return CallLog(path, "a run", false, Answers::in_any_order); };
  {
    CallLog some = look();
    EXPECT_TRUE(some.is_slow());
    EXPECT_EQ(replay(some, 2).why, "no mesh");
    EXPECT_FALSE(replay(some, 2, Verb::pullback).why) << "a product belongs to a point";
    EXPECT_FALSE(replay(some, 4).why);
    append(some, 4, "", 0.25);
    for (const Real x : {3, 1, 4, 4}) {
      const Answer found = replay(some, x);
      EXPECT_EQ(found.why, "") << x;
      EXPECT_EQ(found.y, (std::array<Real, 2>{2 * x, -x}));
    }
    EXPECT_EQ(some.replayed_seconds(), 0.5 + 0.25 + 0.25);
  }
  CallLog again = log();
  for (const Real x : {1, 2, 3, 4}) EXPECT_TRUE(replay(again, x).why) << "they are in order";
  std::filesystem::remove(path);
  write_three(0.05);
  const std::string fast = read_text(path);
  CallLog some = look();
  EXPECT_FALSE(some.is_slow());
  EXPECT_FALSE(replay(some, 1).why);
  append(some, 4, "", 1);
  EXPECT_EQ(read_text(path), fast);
}

TEST_F(Calls, AreRecalledByX) {
  const auto recall = [](CallLog& calls, Real x) {
    Answer answer{{}, {0, 0}};
    const std::span<const Real> request(&x, 1);
    answer.why = calls.recall(std::span(&request, 1), answer.y);
    return answer;
  };
  CallLog none = log(false);
  append(none, 1);
  EXPECT_FALSE(recall(none, 1).why) << "there is no file";
  {
    CallLog begun = log();
    append(begun, 1);
    EXPECT_EQ(recall(begun, 1).why, "");
  }
  write_three();
  CallLog calls = log();
  EXPECT_FALSE(recall(calls, 1).why) << "the run has not made it yet";
  EXPECT_TRUE(replay(calls, 1).why && replay(calls, 2).why);
  EXPECT_EQ(recall(calls, 1).y, (std::array<Real, 2>{2, -1}));
  EXPECT_EQ(recall(calls, 2).why, "no mesh");
  EXPECT_FALSE(recall(calls, 3).why);
  EXPECT_EQ(replay(calls, 3).why, "") << "recalls do not move it";
  append(calls, 4);
  EXPECT_EQ(recall(calls, 4).y, (std::array<Real, 2>{8, -4}));
  EXPECT_EQ(recall(calls, 3).y, (std::array<Real, 2>{6, -3}));
}

TEST_F(Calls, AreWrittenWhereTheFirstIsSlowOrAllAreWanted) {
  for (const auto& [is_forced, seconds, is_written] :
       {std::tuple{false, 0.01, false}, {false, 0.2, true}, {true, 0.0, true}}) {
    std::filesystem::remove(path);
    CallLog calls = log(is_forced);
    EXPECT_FALSE(replay(calls, 1).why);
    append(calls, 1, "", seconds);
    append(calls, 2, "", 1);
    EXPECT_EQ(std::filesystem::exists(path), is_written);
  }
}

}  // namespace
}  // namespace isoline
