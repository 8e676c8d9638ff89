// A command in a record means the same when it is typed again; processor time of an external
// program counts for the run; threads.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/Core>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/clock.h"
#include "core/convolution.h"
#include "core/convolution_kernels.h"
#include "core/errors.h"
#include "core/foreign/foreign.h"
#include "core/records/provenance.h"
#include "core/shell.h"
#include "core/threads.h"

namespace isoline {
namespace {

std::string shell_command(const std::vector<std::string>& words) {
  std::string command;
  for (const std::string& word : words) command += (command.empty() ? "" : " ") + shell_word(word);
  return command;
}

TEST(Shell, WordsAreQuotedOnlyWhereTheyMustBe) {
  EXPECT_EQ(shell_word("--out=results/a.b"), "--out=results/a.b");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("it's"), R"('it'\''s')");
  EXPECT_EQ(shell_word("sine[xi=1|3]"), "'sine[xi=1|3]'");
}

TEST(Shell, WordsOfACommandAreSplitAsAShellSplitsThem) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(shell_words("python3  mine.py\t-x\n"), (Words{"python3", "mine.py", "-x"}));
  EXPECT_EQ(shell_words(R"(a' b 'c"d \e\"f" \g '' $HOME *)"),
            (Words{"a b cd \\e\"f", "g", "", "$HOME", "*"}));
  for (const char* open : {"", "  ", "a 'b", "a \"b", "a \\"})
    EXPECT_THROW(shell_words(open), UsageError) << open;
}

// What `sh` makes of it, each word on a line of its own.
std::string read_back(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(("printf '<%s>' " + command).c_str(), "r"),
                                                   pclose);
  std::string text;
  for (int letter = std::fgetc(pipe.get()); letter != EOF; letter = std::fgetc(pipe.get()))
    text += static_cast<char>(letter);
  return text;
}

TEST(Shell, ReadsEveryWordBackAsItWas) {
  const std::vector<std::string> words = {"it's", "a b", "$HOME", "`date`",    "\\", "\"",
                                          "*",    "~",   "a;b",   "#",         "",   "–ξ’",
                                          "'",    "!x",  "(a|b)", "two\nlines"};
  std::string expected;
  for (const std::string& word : words) expected += "<" + word + ">";
  EXPECT_EQ(read_back(shell_command(words)), expected);
  EXPECT_EQ(shell_words(shell_command(words)), words);
}

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
  const pid_t forked = fork();  // a fork starts without counted processes
  if (forked == 0) _exit(counted_beside() < 0.9 * kEnough ? 0 : 1);
  int status = 1;
  waitpid(forked, &status, 0);
  EXPECT_EQ(status, 0);
}

// Each piece of shared work is done once, and the caller receives its exception. The processor's
// features and the kernel chosen for them.

TEST(Share, DoesEachPieceOnce) {
  for (const std::size_t count : {0, 1, 7, 1000}) {
    std::vector<std::atomic<int>> times(count);
    share(count, [&](std::size_t i) { ++times[i]; });
    for (const auto& done : times) EXPECT_EQ(done, 1);
  }
}

TEST(Share, TellsOnTheCallingThreadAlone) {
  const std::thread::id caller = std::this_thread::get_id();
  share(
      1000, [](std::size_t) {},
      [&](std::size_t done, std::size_t all) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        EXPECT_LE(done, all);
        EXPECT_EQ(all, 1000U);
      });
}

TEST(Share, ThrowsToTheCallerWhatAnyPieceThrew) {
  EXPECT_THROW(share(100,
                     [](std::size_t i) {
                       if (i == 41) throw std::runtime_error("41");
                     }),
               std::runtime_error);
}

TEST(LibraryKernel, IsNotBelowTheProcessorUnlessAUserSaysSo) {
  const LibraryKernel kernel = library_kernel();
  if (kernel.chosen_by == "OpenBLAS" || kernel.chosen_by == "isoline")
    EXPECT_EQ(better_kernel(processor(), kernel.name), "") << kernel.name;
  else
    EXPECT_STRCASEEQ(kernel.name.c_str(), std::getenv("OPENBLAS_CORETYPE"));
}

// In a separate process that Google Test starts: libraries read their environment only once.
[[noreturn]] void leave_if(bool is_so) { std::_Exit(is_so ? 0 : 1); }

TEST(ProvenanceDeathTest, TellsTheVariantsOfTheMathematicalFunctionsApart) {
  if (!processor().has("fma")) GTEST_SKIP() << "the C library has one variant here";
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  setenv("ISOLINE_TEST_LIBM", this_build()->libraries.at("libm").c_str(), 0);
  setenv("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-FMA", 1);
  EXPECT_EXIT(leave_if(this_build()->libraries.at("libm") != std::getenv("ISOLINE_TEST_LIBM")),
              testing::ExitedWithCode(0), "");
  unsetenv("GLIBC_TUNABLES");
  unsetenv("ISOLINE_TEST_LIBM");
}

TEST(ConvolutionInstructions, AreInTheProvenanceAndBelowThoseOfTheBuildAreRefused) {
  EXPECT_TRUE(this_build()->libraries.at("oneDNN").ends_with(" " + convolution_instructions()));
  for (const char* limit : {"", "ALL", "AVX512_CORE", "AVX512_CORE_AMX"})
    EXPECT_TRUE(has_fast_convolutions(limit)) << limit;
  for (const char* limit : {"SSE41", "AVX2"})
    EXPECT_EQ(has_fast_convolutions(limit), kChannels == 8) << limit;
}

#ifndef ISOLINE_PORTABLE

bool is_kernel(const std::string& name, const std::string& chosen_by) {
  return library_kernel().name == name && library_kernel().chosen_by == chosen_by;
}

class LibraryKernelDeathTest : public ::testing::Test {
 protected:
  LibraryKernelDeathTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
  ~LibraryKernelDeathTest() override {  // the tests that follow see the environment they began in
    for (const auto& [variable, value] : before_)
      value ? setenv(variable, value->c_str(), 1) : unsetenv(variable);
  }

 private:
  static std::optional<std::string> value_of(const char* variable) {
    const char* value = std::getenv(variable);
    return value ? std::optional<std::string>(value) : std::nullopt;
  }
  const std::map<const char*, std::optional<std::string>> before_ = {
      {"OPENBLAS_CORETYPE", value_of("OPENBLAS_CORETYPE")},
      {"ISOLINE_KERNEL", value_of("ISOLINE_KERNEL")}};
};

TEST_F(LibraryKernelDeathTest, OfAUserWins) {
  setenv("OPENBLAS_CORETYPE", "Nehalem", 1);
  EXPECT_EXIT(leave_if(is_kernel("Nehalem", "user")), testing::ExitedWithCode(0), "");
}

TEST_F(LibraryKernelDeathTest, IsOursWhereOpenBlasFellBelow) {
  unsetenv("OPENBLAS_CORETYPE");
  unsetenv("ISOLINE_KERNEL");
  EXPECT_EXIT(leave_if(better_kernel(processor(), library_kernel().name).empty() &&
                       library_kernel().chosen_by != "user"),
              testing::ExitedWithCode(0), "");
}

TEST_F(LibraryKernelDeathTest, OfAnUnknownNameIsNotTheUsers) {
  if (better_kernel(processor(), "Prescott") != "SkylakeX")
    GTEST_SKIP() << "OpenBLAS 0.3.21 takes AVX-512 kernels for an unknown name";
  setenv("OPENBLAS_CORETYPE", "Abacus", 1);
  EXPECT_EXIT(leave_if(library_kernel().chosen_by == "OpenBLAS"), testing::ExitedWithCode(0), "");
}
#endif

TEST(CacheSizes, AreThoseThatEigenBlocksBy) {
  EXPECT_EQ(cache_sizes().l1, Eigen::l1CacheSize());
  EXPECT_EQ(cache_sizes().l2, Eigen::l2CacheSize());
  EXPECT_EQ(cache_sizes().l3, Eigen::l3CacheSize());
  EXPECT_LT(cache_sizes().l1, cache_sizes().l2);
#ifdef ISOLINE_PORTABLE
  EXPECT_EQ(cache_sizes().l1, 32 * 1024);
#endif
}

TEST(Processor, NamesItselfAndItsInstructions) {
  EXPECT_FALSE(processor().brand.empty());
#ifdef __AVX2__  // what this was compiled for is what it runs on
  EXPECT_TRUE(processor().has("avx2"));
  EXPECT_TRUE(processor().has("fma"));
#endif
  EXPECT_EQ(processor().has("avx512f"), __builtin_cpu_supports("avx512f") != 0);
  EXPECT_FALSE(processor().has("3dnow!"));
}

const Processor kSse{"of 2008", {"sse3", "ssse3", "sse4_1", "sse4_2"}};
const Processor kAvx2{"of 2013", {"sse3", "avx", "fma", "avx2"}};
const Processor kNoFma{"of a kind that was planned", {"sse3", "avx", "avx2"}};
const Processor kAvx512{
    "of 2017", {"sse3", "avx", "fma", "avx2", "avx512f", "avx512bw", "avx512dq", "avx512vl"}};
const Processor kHalf{"of 2016", {"sse3", "avx", "fma", "avx2", "avx512f", "avx512cd"}};

TEST(BetterKernel, IsAskedForWhereOpenBlasChoseBelowTheProcessor) {
  for (const char* own : {"Prescott", "Haswell", "Zen"})
    EXPECT_EQ(better_kernel(kAvx512, own), "SkylakeX");
  for (const char* own : {"Prescott", "Sandybridge"})
    EXPECT_EQ(better_kernel(kAvx2, own), "Haswell");
  EXPECT_EQ(better_kernel(kHalf, "Prescott"), "Haswell");
  for (const char* own : {"SkylakeX", "Cooperlake"}) EXPECT_EQ(better_kernel(kAvx512, own), "");
  for (const char* own : {"Haswell", "Zen"}) EXPECT_EQ(better_kernel(kAvx2, own), "");
  EXPECT_EQ(better_kernel(kSse, "Nehalem"), "");
  EXPECT_EQ(better_kernel(kNoFma, "Sandybridge"), "");
}

}  // namespace
}  // namespace isoline
