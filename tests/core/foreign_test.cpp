// Frames, handshakes and external programs are valid, or an error names the defect. A program ends
// with its connection.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/foreign/handshake.h"
#include "core/foreign/line.h"
#include "core/json.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace isoline {
namespace {

std::string frame(std::uint32_t verb, std::uint32_t status, std::uint64_t bytes,
                  const std::string& payload) {
  const FrameHead head{verb, status, bytes};
  return std::string(reinterpret_cast<const char*>(&head), sizeof head) + payload;
}

std::string bytes_of(std::span<const double> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

// A line whose other end is this very test.
struct BothEnds {
  BothEnds() {
    int ends[2];
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
    line = std::make_unique<Line>(ends[0]);
    other = ends[1];
  }
  ~BothEnds() { hang_up(); }
  void write(const std::string& bytes) const {
    EXPECT_EQ(::write(other, bytes.data(), bytes.size()), std::ssize(bytes));
  }
  void hang_up() {
    if (other >= 0) ::close(other);
    other = -1;
  }

  std::unique_ptr<Line> line;
  int other = -1;
};

// What is said of an answer to a pullback of two numbers.
std::string said_of(const std::string& answer, bool hangs_up = true, double seconds = 5) {
  BothEnds ends;
  ends.write(answer);
  if (hangs_up) ends.hang_up();
  std::array<double, 2> numbers{};
  return refusal<LineError>([&] { ends.line->receive_answer(Verb::pullback, numbers, seconds); });
}

void expect_refused(const std::string& answer, const std::string& part) {
  const std::string said = said_of(answer);
  EXPECT_NE(said.find(part), std::string::npos) << said;
}

constexpr std::array<double, 2> kNumbers = {1.5, -2};

TEST(Line, NumbersArriveAsTheyWereSent) {
  BothEnds ends;
  ends.write(frame(4, 0, 16, bytes_of(kNumbers)));
  std::array<double, 2> numbers{};
  ends.line->receive_answer(Verb::pullback, numbers);
  EXPECT_EQ(numbers, kNumbers);
  ends.line->send(Verb::linearize, 7, kNumbers);
  std::array<char, 32> got{};
  EXPECT_EQ(::read(ends.other, got.data(), got.size()), 32);
  EXPECT_EQ(std::string(got.data(), got.size()), frame(2, 7, 16, bytes_of(kNumbers)));
}

TEST(Line, AnAnswerThatNobodyAskedForIsNotTakenForTheNext) {
  BothEnds ends;
  ends.write(frame(4, 0, 16, bytes_of(kNumbers)) + frame(4, 0, 16, bytes_of(kNumbers)));
  std::array<double, 2> numbers{};
  ends.line->receive_answer(Verb::pullback, numbers);
  EXPECT_THROW(ends.line->send(Verb::pullback, 0, kNumbers), LineError);
}

TEST(Line, AFrameThatComesByTheByteIsTheSame) {
  BothEnds ends;
  const std::string whole = frame(4, 0, 16, bytes_of(kNumbers));
  const pid_t writer = fork();
  if (writer == 0) {
    for (const char each : whole) {
      usleep(200);
      if (::write(ends.other, &each, 1) != 1) _exit(1);
    }
    _exit(0);
  }
  std::array<double, 2> numbers{};
  ends.line->receive_answer(Verb::pullback, numbers, 10);
  EXPECT_EQ(numbers, kNumbers);
}

TEST(Line, WhatBreaksTheLawOfFramesIsRefused) {
  expect_refused("", "closed the connection");
  expect_refused(frame(4, 0, 16, "").substr(0, 9), "closed the connection");
  expect_refused(frame(4, 0, 16, "12345678"), "closed the connection");
  expect_refused(frame(4, 0, std::uint64_t{1} << 63, bytes_of(kNumbers)),
                 "pullback with 9223372036854775808 bytes instead");
  expect_refused(frame(4, 0, 8, "12345678"), "8 bytes instead of 16");
  expect_refused(frame(4, 0, 8, bytes_of(kNumbers)), "more bytes than");
  expect_refused(frame(99, 0, 16, bytes_of(kNumbers)), "a frame of verb 99");
}

TEST(Line, AComplaintIsQuotedWithinBounds) {
  expect_refused(frame(4, 1, 21, "the mesh is \xff tangled"), "pullback: the mesh is \uFFFD");
  expect_refused(frame(4, 1, 2, "no"), "failed at pullback: no");
  expect_refused(frame(4, 1, std::uint64_t{1} << 63, "long"),
                 "9223372036854775808 bytes; at most 65536");
}

TEST(Line, ADeadlineIsKept) {
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_NE(said_of(frame(4, 0, 16, "1234"), false, 0.05).find("0.05 s"), std::string::npos);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST(Line, APauseOfTheWaitingProcessDoesNotCountTowardItsDeadline) {
  BothEnds ends;
  const pid_t waiting = fork();
  if (waiting == 0) {
    raise(SIGSTOP);
    std::array<double, 2> numbers{};
    try {
      ends.line->receive_answer(Verb::pullback, numbers, 3);
    } catch (const LineError&) {
      _exit(1);
    }
    _exit(numbers == kNumbers ? 0 : 2);
  }
  int status = 0;
  ASSERT_EQ(waitpid(waiting, &status, WUNTRACED), waiting);
  kill(waiting, SIGCONT);
  usleep(200'000);  // it waits
  kill(waiting, SIGSTOP);
  usleep(3'500'000);
  kill(waiting, SIGCONT);
  usleep(200'000);
  ends.write(frame(4, 0, 16, bytes_of(kNumbers)));
  ASSERT_EQ(waitpid(waiting, &status, 0), waiting);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

TEST(Line, AQuestionLongerThanItsRoomIsRefusedBeforeItIsRead) {
  BothEnds ends;
  ends.write(frame(17, 0, std::uint64_t{1} << 40, ""));
  std::array<double, 4> room{};
  EXPECT_NE(refusal<LineError>([&] { ends.line->receive(room); }).find("bytes; at most 32"),
            std::string::npos);
}

// --- programs

ChildProgram::Start shell(const std::string& script) {
  return {.command = "sh -c '" + script + "'"};
}

std::string failure_of(const std::string& script, double seconds = 20) {
  Line line(shell(script));
  std::array<double, 1> numbers{};
  return refusal<LineError>([&] { line.receive_answer(Verb::linearize, numbers, seconds); });
}

TEST(Programs, HowTheyEndAndWhatTheyPrintedLastIsSaid) {
  const std::string said = failure_of("echo one; echo two >&2; exit 3");
  EXPECT_NE(said.find("code 3; its last output was: one\ntwo"), std::string::npos) << said;
  EXPECT_NE(failure_of("kill -9 $$").find("signal 9 (Killed) ended it"), std::string::npos);
}

TEST(Programs, OfPythonEndWithTheirExceptionAndItsPlace) {
  const std::string frame = "echo \"  File \\\"a.py\\\", line 4, in load\"; echo \"    rows[n]\";";
  const std::string said =
      failure_of("echo Traceback:; " + frame + frame + "echo \"KeyError: 7\"; exit 1");
  EXPECT_TRUE(said.ends_with("output was: KeyError: 7 (File \"a.py\", line 4, in load)")) << said;
  EXPECT_NE(failure_of(frame + "exit 1").find("rows[n]"), std::string::npos);
  const std::string place = "echo Traceback:; echo \"  File \\\"a.py\\\", line 4\"; exit 1";
  EXPECT_TRUE(failure_of(place).ends_with("line 4"));
  const std::string syntax = "printf \"  File \\\"a.py\\\", line 4\\n    y = [\\n        ^\\n\"; ";
  EXPECT_TRUE(failure_of(syntax + "echo \"SyntaxError: 1\"; exit 1")
                  .ends_with("output was: SyntaxError: 1 (File \"a.py\", line 4)"));
}

TEST(Programs, ThatPrintAGigabyteAreReadToTheEndInLittleMemory) {
  const std::string said = failure_of("head -c 1000000000 /dev/zero; echo; echo the end; exit 5");
  EXPECT_NE(said.find("code 5; its last output was: "), std::string::npos) << said.substr(0, 200);
  EXPECT_TRUE(said.ends_with("the end")) << said.substr(0, 200);
  EXPECT_LT(said.size(), 4000U);
}

TEST(Programs, FindTheirEndOfTheLineByItsNumber) {
  Line line(
      shell("printf \"\\001\\000\\000\\000\\000\\000\\000\\000\\002\\000\\000\\000\\000\\000"
            "\\000\\000hi\" >&$ISOLINE_FD"));
  EXPECT_EQ(line.receive_text(Verb::hello, 10, 20), "hi");
}

TEST(Programs, ThatAreNotThereAreNamed) {
  const std::string said = refusal([] { const Line line({.command = "a-missing-program 'x y'"}); });
  EXPECT_NE(said.find("'a-missing-program': No such file"), std::string::npos) << said;
}

// A process that has ended and is not yet waited for has no command.
bool runs(const std::string& process) {
  std::ifstream file("/proc/" + process + "/cmdline");
  return file.get() != std::ifstream::traits_type::eof();
}

TEST(Programs, EndWithTheirLineAndSoDoesWhatTheyStarted) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "process";
  std::string process;
  {
    Line line(shell("sleep 1000 & echo $! >" + file.string() + ".new; mv " + file.string() +
                    ".new " + file.string() + "; read x <&$ISOLINE_FD"));
    for (int i = 0; i < 2000 && !std::filesystem::exists(file); ++i) usleep(10'000);
    std::ifstream(file) >> process;
    ASSERT_FALSE(process.empty());
    EXPECT_TRUE(runs(process));
  }
  for (int i = 0; i < 2000 && runs(process); ++i) usleep(10'000);
  EXPECT_FALSE(runs(process));
}

Json a_problem() {
  return {{"protocol", 1},
          {"role", "problem"},
          {"name", "spring"},
          {"inputs", 2},
          {"outputs", 3},
          {"oracles", {"forward", "pullback"}},
          {"start", {1, 2}},
          {"target", {0, 0.5, "inf"}},
          {"interpreter", "CPython 3.11.2"},
          {"packages", {{"numpy", "1.24.2"}}}};
}

// The complaint about a problem that says something else in one member.
std::string complaint(const std::string& member, const Json& value) {
  Json json = a_problem();
  json[member] = value;
  return refusal([&] { problem_handshake(json_text(json), "`mine`"); });
}

TEST(Handshakes, OfAProblemSayWhatItIs) {
  const ProblemHandshake said = problem_handshake(json_text(a_problem()), "`mine`");
  EXPECT_EQ(said.inputs, 2);
  EXPECT_EQ(said.outputs, 3);
  EXPECT_TRUE(said.oracles.contains(Oracle::pullback));
  EXPECT_FALSE(said.oracles.contains(Oracle::pushforward));
  EXPECT_TRUE(std::isinf(said.target[2])) << "what is not finite is data";
  EXPECT_EQ(said.foreign.label, "spring");
  EXPECT_EQ(said.foreign.packages.at("numpy"), "1.24.2");
  EXPECT_EQ(said.inverse, "");
  EXPECT_FALSE(said.minimum);
}

TEST(Handshakes, ThatBreakTheLawAreQuoted) {
  const std::string whole = "a whole number in [1, 134217728]";
  const struct {
    std::string member;
    Json value;
    std::string law;
  } all[] = {{"inputs", -3, whole},
             {"inputs", 18446744073709551615ULL, whole},
             {"outputs", 2.5, whole},
             {"start", {1, 2, 3}, "a list of 2 numbers"},
             {"target", {1, 2, "three"}, "a list of 3 numbers"},
             {"oracles", {"forward", "gradient"}, " pushforward pullback jacobian inverse"},
             {"name", Json::array({1}), "at most 64 bytes"},
             {"packages", {{"numpy", 1}}, "64 bytes each"},
             {"inverse", "perfect", "exact damped estimate approximate"},
             {"minimum", "small", "a number"}};
  for (const auto& [member, value, law] : all) {
    const std::string said = complaint(member, value);
    EXPECT_TRUE(said.starts_with("`mine` declares " + member + " = " + json_text(value) + ", "))
        << said;
    EXPECT_TRUE(said.ends_with(law)) << said;
  }
  EXPECT_TRUE(complaint("target", nullptr).starts_with("`mine` does not declare target"));
}

TEST(Handshakes, OfAnotherProtocolOrRoleAreRefused) {
  EXPECT_TRUE(complaint("protocol", 2).starts_with("`mine` uses protocol 2, "));
  EXPECT_TRUE(complaint("role", "optimizer").starts_with("`mine` is an optimizer, "));
  for (const char* text : {"", "[]", "{", "nonsense", "3"})
    EXPECT_THROW(problem_handshake(text, "`mine`"), UsageError) << text;
  EXPECT_THROW(problem_handshake(std::string(100'000, '['), "`mine`"), UsageError);
}

TEST(Handshakes, BoundsLieOneBelowTheOtherAndHoldEveryPointThatIsSaid) {
  for (const Json& wrong : {Json{{0, 1}, {0, 0.5}}, Json{{0, 0}, {1, "nan"}}, Json{{0, 0}},
                            Json{{0}, {1}}, Json("none"), Json{{0, 0}, {1, "one"}}})
    EXPECT_TRUE(
        complaint("bounds", wrong).starts_with("`mine` declares bounds = " + json_text(wrong)));
  Json json = a_problem();
  json["start"] = {1, 2};
  json["bounds"] = {{"-inf", 2}, {1, "inf"}};
  const ProblemHandshake said = problem_handshake(json_text(json), "`mine`");
  EXPECT_EQ(said.lower, (std::vector<Real>{-std::numeric_limits<Real>::infinity(), 2}));
  EXPECT_EQ(said.upper, (std::vector<Real>{1, std::numeric_limits<Real>::infinity()}));
  EXPECT_TRUE(said.foreign.note.ends_with("its bounds on x."));
  json["truth"] = {2, 2};
  EXPECT_TRUE(refusal([&] {
                problem_handshake(json_text(json), "`mine`");
              }).starts_with("`mine` declares a truth"));
}

TEST(Handshakes, AnInverseAndItsKindBelongTogether) {
  EXPECT_NE(complaint("inverse", "exact"), "");
  Json json = a_problem();
  json["oracles"].push_back("inverse");
  EXPECT_THROW(problem_handshake(json_text(json), "`mine`"), UsageError);
  json["inverse"] = "damped";
  EXPECT_EQ(problem_handshake(json_text(json), "`mine`").inverse, "damped");
}

TEST(Handshakes, WhoSeeksXSaysWhich) {
  EXPECT_TRUE(complaint("aim", "x").ends_with("truth or x_error"));
  Json json = a_problem();
  json.update({{"aim", "x"}, {"has_x_error", true}, {"start_scale", "own"}, {"x_floor", 0.5}});
  const ProblemHandshake said = problem_handshake(json_text(json), "`mine`");
  EXPECT_TRUE(said.has_x_error && said.has_own_scale && said.x_floor == 0.5);
  EXPECT_NE(complaint("x_floor", -1), "");
}

// A name of a megabyte would stand in each row of each table.
TEST(Handshakes, TextsHaveTheLimitsOfPlugins) {
  EXPECT_EQ(complaint("name", std::string(64, 'a')), "");
  EXPECT_NE(complaint("name", std::string(65, 'a')), "");
  EXPECT_NE(complaint("note", std::string(5000, 'a')), "");
  EXPECT_NE(complaint("packages", {{"numpy", std::string(100, '1')}}), "");
}

TEST(Handshakes, DeclareOptionsWithTheTypesOfTheirDefaults) {
  Json json = a_problem();
  json["options"] = {{{"name", "n"}, {"default", 4}, {"doc", "size"}},
                     {{"name", "rate"}, {"default", 0.5}},
                     {{"name", "kind"}, {"default", "a"}}};
  json["tunable"] = "rate";
  const Foreign said = problem_handshake(json_text(json), "`mine`").foreign;
  ASSERT_EQ(said.options.size(), 3U);
  EXPECT_EQ(said.options[0].standard, OptionValue(Index{4}));
  EXPECT_EQ(said.options[1].standard, OptionValue(0.5));
  EXPECT_EQ(said.options[2].standard, OptionValue(std::string("a")));
  EXPECT_EQ(said.tunable, "rate");
  for (const Json& wrong :
       {Json("n"), Json::array({1}), Json::array({{{"name", "n"}}}),
        Json::array({{{"name", "a b"}, {"default", 1}}}),
        Json::array({{{"name", "command"}, {"default", "x"}}}),
        Json::array({{{"name", "n"}, {"default", nullptr}}}),
        Json::array({{{"name", "n"}, {"default", 1}}, {{"name", "n"}, {"default", 2}}})}) {
    json["options"] = wrong;
    EXPECT_THROW(problem_handshake(json_text(json), "`mine`"), UsageError) << wrong;
  }
  json.erase("options");
  EXPECT_THROW(problem_handshake(json_text(json), "`mine`"), UsageError) << "tunable has no option";
}

TEST(Handshakes, OfAnOptimizerSayWhatItAsks) {
  const Json json{
      {"protocol", 1}, {"role", "optimizer"}, {"needs", {"jacobian"}}, {"least_squares", true}};
  const MethodHandshake said = method_handshake(json_text(json), "`mine`");
  EXPECT_TRUE(said.needs.contains(Oracle::forward) && said.needs.contains(Oracle::jacobian));
  EXPECT_FALSE(said.needs.contains(Oracle::pullback));
  EXPECT_TRUE(said.is_least_squares);
  EXPECT_FALSE(said.reports || said.keeps_bounds);
  Json bad = json;
  bad["needs"] = {"truth"};
  EXPECT_THROW(method_handshake(json_text(bad), "`mine`"), UsageError) << "it is a privilege";
  Json bounded = json;
  bounded["keeps_bounds"] = true;
  EXPECT_TRUE(method_handshake(json_text(bounded), "`mine`").keeps_bounds);
}

}  // namespace
}  // namespace isoline
