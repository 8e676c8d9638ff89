// Every piece of shared work is done once, and what it throws reaches the caller.
#include "core/threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
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

}  // namespace
}  // namespace isoline
