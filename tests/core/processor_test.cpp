// What the processor says of itself, and the kernel that is asked for on processors of every kind.
#include <gtest/gtest.h>

#include "core/threads.h"

namespace isoline {
namespace {

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
  EXPECT_EQ(better_kernel(kAvx512, "Prescott"), "SkylakeX");
  EXPECT_EQ(better_kernel(kAvx512, "Haswell"), "SkylakeX");
  EXPECT_EQ(better_kernel(kAvx512, "Zen"), "SkylakeX");
  EXPECT_EQ(better_kernel(kAvx2, "Prescott"), "Haswell");
  EXPECT_EQ(better_kernel(kAvx2, "Sandybridge"), "Haswell");
  EXPECT_EQ(better_kernel(kHalf, "Prescott"), "Haswell");
}

TEST(BetterKernel, IsNoneWhereOpenBlasChoseWell) {
  EXPECT_EQ(better_kernel(kAvx512, "SkylakeX"), "");
  EXPECT_EQ(better_kernel(kAvx512, "Cooperlake"), "");
  EXPECT_EQ(better_kernel(kAvx2, "Haswell"), "");
  EXPECT_EQ(better_kernel(kAvx2, "Zen"), "");
  EXPECT_EQ(better_kernel(kSse, "Nehalem"), "");
  EXPECT_EQ(better_kernel(kNoFma, "Sandybridge"), "");
}

}  // namespace
}  // namespace isoline
