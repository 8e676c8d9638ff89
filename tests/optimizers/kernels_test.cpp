// Every method computes the same θ by different kernels of OpenBLAS.
#include <cstdlib>
#include <fstream>
#include <optional>

#include "core/threads.h"
#include "tests/optimizers/run.h"
#include "tests/temporary_folder.h"

namespace isoline::optimizers {
namespace {

constexpr const char* kFile = "ISOLINE_KERNELS_TEST";  // main.cpp leaves its process as it is

struct Named {
  std::string name;
  Vector theta;  // after three steps, on networks in double precision
};
std::vector<Named> thetas() {
  std::vector<Named> all;
  for (const char* spec : {"hig-toy[batch=16,data=16]",
                           "sine[mode=learn,xi=2,batch=7,network=mlp[layers=8-6,activation=tanh,"
                           "precision=double]]"}) {
    const Problem problem = make(spec);
    for (const auto& [name, entry] : optimizers()) {
      if (!why(name, problem).empty()) continue;
      // Without a cut-off it divides by singular values that are rounding alone.
      const std::string method = name == "gauss-newton" ? "gauss-newton[cutoff=1e-6]" : name;
      all.push_back({name + " on " + spec, run(problem, method, iterations(3)).theta});
    }
  }
  return all;
}

std::streamsize bytes(const Vector& theta) {
  return theta.size() * static_cast<std::streamsize>(sizeof(Real));
}

[[noreturn]] void write_thetas() {
  std::ofstream out(std::getenv(kFile), std::ios::binary);
  for (const Named& one : thetas())
    out.write(reinterpret_cast<const char*>(one.theta.data()), bytes(one.theta));
  out.close();
  std::_Exit(out ? 0 : 1);
}

// In a process that Google Test starts, since OpenBLAS reads its environment once.
TEST(KernelsDeathTest, GiveEveryMethodTheSameTheta) {
  const std::string own = library_kernel().name, other = own == "Prescott" ? "Haswell" : "Prescott";
  if (!processor().has("avx2")) GTEST_SKIP() << "the processor lacks the other kernel";
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  std::optional<TemporaryFolder> folder;  // in the first process alone
  if (!std::getenv(kFile)) setenv(kFile, (folder.emplace().path() / "thetas").c_str(), 1);
  const char* set = std::getenv("OPENBLAS_CORETYPE");
  const std::optional<std::string> before = set ? std::optional<std::string>(set) : std::nullopt;
  setenv("OPENBLAS_CORETYPE", other.c_str(), 1);
  EXPECT_EXIT(write_thetas(), testing::ExitedWithCode(0), "");
  before ? setenv("OPENBLAS_CORETYPE", before->c_str(), 1) : unsetenv("OPENBLAS_CORETYPE");
  std::ifstream in(std::getenv(kFile), std::ios::binary);
  unsetenv(kFile);
  bool is_equal = true;  // to the bit: then both processes had the same kernel
  for (const Named& one : thetas()) {
    Vector theta(one.theta.size());
    ASSERT_TRUE(in.read(reinterpret_cast<char*>(theta.data()), bytes(theta)));
    is_equal = is_equal && theta == one.theta;
    const bool is_squared = one.name.starts_with("libdogleg");  // it solves with JᵀJ, unscaled
    if (one.theta.allFinite()) expect_near(theta, one.theta, is_squared ? 1e-5 : 1e-8, one.name);
  }
  EXPECT_FALSE(is_equal) << own << ", " << other;
}

}  // namespace
}  // namespace isoline::optimizers
