// The features in CPUID: Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2A,
// and the registers that the system keeps by XGETBV, volume 1, 13.3.
#include "core/threads.h"

#include <omp.h>
#include <strings.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#ifdef __x86_64__
#include <cpuid.h>
#endif

namespace isoline {

bool Processor::has(const std::string& feature) const {
  return std::find(features.begin(), features.end(), feature) != features.end();
}

namespace {

#ifdef __x86_64__

using Registers = std::array<unsigned, 4>;  // eax, ebx, ecx, edx

Registers cpuid(unsigned leaf, unsigned part = 0) {
  Registers r{};
  __get_cpuid_count(leaf, part, &r[0], &r[1], &r[2], &r[3]);  // zeros beyond the last leaf
  return r;
}

std::string brand() {
  constexpr unsigned kFirst = 0x80000002;  // three leaves of sixteen characters
  std::string text;
  for (unsigned leaf = kFirst; leaf < kFirst + 3; ++leaf)
    for (const unsigned four : cpuid(leaf))
      for (int shift = 0; shift < 32; shift += 8)
        if (const auto letter = static_cast<char>(four >> shift & 0xFF)) text += letter;
  const auto begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "unknown"
                                    : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

// Parts of the registers' state that the system saves, as bits of XCR0.
constexpr std::uint64_t kAlways = 0, kAvx = 0x06, kAvx512 = 0xE6, kTiles = 0x60000;

std::uint64_t kept_state() {
  constexpr unsigned kOsxsave = 1U << 27;
  if ((cpuid(1)[2] & kOsxsave) == 0) return 0;
  unsigned low = 0, high = 0;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return std::uint64_t{high} << 32 | low;
}

struct Feature {
  std::string_view name;
  unsigned leaf, part, word, bit;  // word: 0 eax, 1 ebx, 2 ecx, 3 edx
  std::uint64_t state;
};

constexpr Feature kFeatures[] = {
    {"sse3", 1, 0, 2, 0, kAlways},
    {"ssse3", 1, 0, 2, 9, kAlways},
    {"sse4_1", 1, 0, 2, 19, kAlways},
    {"sse4_2", 1, 0, 2, 20, kAlways},
    {"avx", 1, 0, 2, 28, kAvx},
    {"f16c", 1, 0, 2, 29, kAvx},
    {"fma", 1, 0, 2, 12, kAvx},
    {"avx2", 7, 0, 1, 5, kAvx},
    {"bmi1", 7, 0, 1, 3, kAlways},
    {"bmi2", 7, 0, 1, 8, kAlways},
    {"avx_vnni", 7, 1, 0, 4, kAvx},
    {"avx512f", 7, 0, 1, 16, kAvx512},
    {"avx512dq", 7, 0, 1, 17, kAvx512},
    {"avx512cd", 7, 0, 1, 28, kAvx512},
    {"avx512bw", 7, 0, 1, 30, kAvx512},
    {"avx512vl", 7, 0, 1, 31, kAvx512},
    {"avx512_vnni", 7, 0, 2, 11, kAvx512},
    {"avx512_bf16", 7, 1, 0, 5, kAvx512},
    {"avx512_fp16", 7, 0, 3, 23, kAvx512},
    {"amx_tile", 7, 0, 3, 24, kTiles},
};

Processor read_processor() {
  Processor read{.brand = brand(), .features = {}};
  const std::uint64_t kept = kept_state();
  for (const Feature& f : kFeatures)
    if ((cpuid(f.leaf, f.part)[f.word] >> f.bit & 1) != 0 && (kept & f.state) == f.state)
      read.features.emplace_back(f.name);
  return read;
}

#else

Processor read_processor() { return {.brand = "unknown", .features = {}}; }

#endif

}  // namespace

const Processor& processor() {
  static const Processor read = read_processor();
  return read;
}

}  // namespace isoline

// Threads of the libraries: one before main, more where a request says so. Their kernels and
// caches.
extern "C" void openblas_set_num_threads(int threads);
extern "C" char* openblas_get_corename();

namespace isoline {
namespace {

#ifdef ISOLINE_PORTABLE
constexpr bool kIsPortable = true;
#else
constexpr bool kIsPortable = false;
#endif

constexpr CacheSizes kCacheSizes{ISOLINE_CACHE_SIZES};  // by the build: core/CMakeLists.txt

constexpr const char* kKernel = "OPENBLAS_CORETYPE";
// A second variable stores our own choice, to distinguish it from the user's.
constexpr const char* kOurKernel = "ISOLINE_KERNEL";

using Setting = std::pair<const char*, std::string>;

std::string setting(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? "" : value;
}

std::vector<Setting> wanted_environment() {
  std::vector<Setting> wanted{{"OPENBLAS_NUM_THREADS", "1"}, {"OMP_NUM_THREADS", "1"}};
  if (kIsPortable) {  // the same kernels on every machine
    wanted.emplace_back(kKernel, "Haswell");
    wanted.emplace_back("ONEDNN_MAX_CPU_ISA", "AVX2");
  } else if (setting(kKernel).empty()) {
    if (const std::string better = better_kernel(processor(), openblas_get_corename());
        !better.empty()) {
      wanted.emplace_back(kKernel, better);
      wanted.emplace_back(kOurKernel, better);
    }
  }
  return wanted;
}

}  // namespace

void prepare_libraries(char** arguments) {
  Eigen::setCpuCacheSizes(kCacheSizes.l1, kCacheSizes.l2, kCacheSizes.l3);
  bool is_set = true;
  for (const auto& [variable, value] : wanted_environment()) {
    is_set = is_set && setting(variable) == value;
    setenv(variable, value.c_str(), 1);
  }
  if (!is_set) execv("/proc/self/exe", arguments);  // on failure we go on, with idle threads
}

LibraryKernel library_kernel() {
  const std::string name = openblas_get_corename(), asked = setting(kKernel);
  const bool is_granted = strcasecmp(name.c_str(), asked.c_str()) == 0;  // an unknown one is not
  if (!is_granted) return {name, "OpenBLAS"};
  if (kIsPortable) return {name, "portable"};
  return {name, setting(kOurKernel) == asked ? "isoline" : "user"};
}

std::string better_kernel(const Processor& processor, const std::string& own) {
  constexpr std::array<std::string_view, 3> kAvx512{"SkylakeX", "Cooperlake", "SapphireRapids"};
  constexpr std::array<std::string_view, 3> kAvx2{"Haswell", "Zen", "Excavator"};
  const auto is_among = [&](const auto& names) {
    return std::find(names.begin(), names.end(), own) != names.end();
  };
  const auto has = [&](const auto&... features) { return (processor.has(features) && ...); };
  if (is_among(kAvx512)) return "";
  if (has("avx512f", "avx512bw", "avx512dq", "avx512vl")) return "SkylakeX";
  if (is_among(kAvx2)) return "";
  return has("avx2", "fma") ? "Haswell" : "";
}

CacheSizes cache_sizes() {
  return {Eigen::l1CacheSize(), Eigen::l2CacheSize(), Eigen::l3CacheSize()};
}

void set_library_threads(int threads) {
  if (threads <= 1) return;
  openblas_set_num_threads(threads);
  omp_set_num_threads(threads);
}

int library_threads() { return omp_get_max_threads(); }

void run_tasks(Index tasks, const std::function<void(Index task, int thread)>& work) {
#pragma omp parallel for schedule(dynamic)
  for (Index task = 0; task < tasks; ++task) work(task, omp_get_thread_num());
}

OneThread::OneThread() : threads_(omp_get_max_threads()) { omp_set_num_threads(1); }
OneThread::~OneThread() { omp_set_num_threads(threads_); }

void share(std::size_t count, const std::function<void(std::size_t)>& work,
           const Listener& listener) {
  constexpr unsigned kMostThreads = 8;
  constexpr std::size_t kOften = 64;
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex mutex;
  const auto some = [&](const Listener& told) {
    std::size_t due = 0;  // the next task, for whichever thread is free
    try {
      for (std::size_t i = next++; i < count; i = next++) {
        work(i);
        if (!told || i < due) continue;
        told(i + 1, count);
        due = i + kOften;
      }
    } catch (...) {
      next = count;
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    const unsigned threads = std::clamp(std::thread::hardware_concurrency(), 1U, kMostThreads);
    for (unsigned i = 1; i < threads && i < count; ++i) others.emplace_back(some, Listener());
    some(listener);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace isoline
