// Every piece of shared work is done once, and what it throws reaches the caller. The processor's
// features, and the kernel that is chosen for them.
#include "core/threads.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <atomic>
#include <cstdlib>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace isoline {
namespace {

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

#ifndef ISOLINE_PORTABLE
// In a process of its own that Google Test starts anew: OpenBLAS reads its environment but once.
[[noreturn]] void leave_if(bool is_so) { std::_Exit(is_so ? 0 : 1); }

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
