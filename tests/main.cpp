// Every test program: its libraries are prepared by the same door as the program's, then it runs
// what Google Test is asked for. ISOLINE_TEST_THREADS raises the libraries' threads.
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/threads.h"

int main(int count, char** arguments) {
  // optimizers/kernels_test.cpp starts a process with kernels of its own.
  if (!std::getenv("ISOLINE_KERNELS_TEST")) isoline::prepare_libraries(arguments);
  if (const char* threads = std::getenv("ISOLINE_TEST_THREADS"))
    isoline::set_library_threads(std::atoi(threads));
  testing::InitGoogleTest(&count, arguments);
  return RUN_ALL_TESTS();
}
