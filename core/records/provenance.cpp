// The origin of a result: version, commit, compiler, processor, libraries.
#include "core/records/provenance.h"

#include <fmt/format.h>
#include <gnu/libc-version.h>
#include <sys/utsname.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

#include "core/convolution_kernels.h"
#include "core/files.h"
#include "core/threads.h"
#include "isoline_build_flags.h"
#include "isoline_build_info.h"

namespace isoline {
namespace {

// Set by a program built elsewhere, before its build is read.
struct Tree {
  std::string commit;
  bool is_dirty = false;
};
std::optional<Tree>& program_tree() {
  static std::optional<Tree> tree;
  return tree;
}

// The value of `key` in a file of "key<separator>value" lines, or "unknown".
std::string value_in(const char* path, const std::string& key, char separator) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const auto start = line.find_first_not_of("\t \"", line.find(separator) + 1);
    const auto end = line.find_last_not_of("\t \"");
    if (start != std::string::npos) return line.substr(start, end - start + 1);
  }
  return "unknown";
}

std::string instruction_set() {
  std::string set = ISOLINE_MARCH;
#ifdef __AVX2__
  set += " avx2";
#endif
#ifdef __FMA__
  set += " fma";
#endif
#ifdef __AVX512F__
  set += " avx512f";
#endif
  return set;
}

// Digest of values that the C library returns here. Its functions have variants for processors, and
// updates of a distribution change last digits under an equal version. Variants differ at about one
// argument in two thousand: these are some where glibc 2.36 with and without FMA does, for each
// function that has both.
std::string digest_of_mathematics() {
  std::string all;
  for (const double x : {0.099, 0.259, 0.378, 0.529, 0.991, 1.31, 1.767, 1.881, 2.192, 2.851, 5.989,
                         8.743, 12.299, 28.304, 0.21802, 0.04921}) {
    const volatile double unknown = x;  // to the compiler, which would compute them itself
    const double v = unknown;
    for (const double y : {std::exp(v), std::log(v), std::pow(v, 1.7), std::sin(v), std::cos(v),
                           std::tan(v), std::atan(v), std::sinh(v), std::cosh(v), std::tanh(v),
                           std::expm1(v), std::log1p(v), std::log2(v), std::cbrt(v), std::erf(v)})
      all += fmt::format("{} ", y);
  }
  return digest(all);
}

std::map<std::string, std::string> libraries() {
  std::map<std::string, std::string> versions;
  std::istringstream list(ISOLINE_LIBRARIES);  // "Name version;Name version"
  for (std::string library; std::getline(list, library, ';');)
    versions[library.substr(0, library.find(' '))] = library.substr(library.find(' ') + 1);
  versions["OpenBLAS"].append(" ").append(library_kernel().name);
  versions["oneDNN"] += " " + convolution_instructions();
  versions["FFTW"] = fourier_version();
  versions["libm"] = fmt::format("{} {}", gnu_get_libc_version(), digest_of_mathematics());
  return versions;
}

std::string system_name() {
  utsname kernel{};
  uname(&kernel);
  return fmt::format("{}, {} {}", value_in("/etc/os-release", "PRETTY_NAME", '='), kernel.sysname,
                     kernel.release);
}

std::shared_ptr<const Build> read_build() {
  const auto build = std::make_shared<Build>();
  build->version = version();
  build->commit = kCommit;
  build->is_dirty = kDirty;
  if (const std::optional<Tree>& tree = program_tree()) {
    build->isoline_commit = std::exchange(build->commit, tree->commit);
    build->is_dirty = tree->is_dirty;
  }
  build->compiler = "g++ " __VERSION__;
  build->build_type = ISOLINE_BUILD_TYPE;
  build->flags = ISOLINE_FLAGS;
  build->instruction_set = instruction_set();
  build->processor = processor().brand;
  build->processor_features = processor().features;
  const LibraryKernel kernel = library_kernel();
  build->kernel = kernel.name;
  build->kernel_chosen_by = kernel.chosen_by;
  const CacheSizes caches = cache_sizes();
  build->cache_bytes = {{"l1", caches.l1}, {"l2", caches.l2}, {"l3", caches.l3}};
  build->cores = std::thread::hardware_concurrency();
  build->system = system_name();
  build->libraries = libraries();
  return build;
}

}  // namespace

Provenance::Provenance() {
  static const auto unknown = std::make_shared<const Build>();
  build = unknown;
}

std::string version() { return ISOLINE_VERSION; }

const std::shared_ptr<const Build>& this_build() {
  static const std::shared_ptr<const Build> read = read_build();
  return read;
}

void set_program_tree(std::string commit, bool is_dirty) {
  program_tree() = {std::move(commit), is_dirty};
}

const std::string& platform_digest() {
  static const std::string found = [] {
    const Build& build = *this_build();
    const CacheSizes caches = cache_sizes();
    std::string text =
        fmt::format("{} {} {} {} {} {} {}", build.compiler, build.build_type, build.flags,
                    build.instruction_set, caches.l1, caches.l2, caches.l3);
    for (const char* name : {"Ceres", "NLopt", "cminpack", "GSL", "Eigen", "OpenBLAS", "FFTW",
                             "oneDNN", "Random123", "libm"})
      text += fmt::format(" {} {}", name, build.libraries.at(name));
    return digest(text);
  }();
  return found;
}

}  // namespace isoline
