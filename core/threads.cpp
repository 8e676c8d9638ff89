// The processor by CPUID, and the environment of the libraries that compute.
#include "core/threads.h"

#include <fmt/format.h>
#include <omp.h>
#include <sched.h>
#include <strings.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "core/convolution_kernels.h"
#include "core/text.h"

#ifdef __x86_64__
#include <cpuid.h>
#endif

extern "C" void openblas_set_num_threads(int threads);
extern "C" char* openblas_get_corename();

namespace isoline {

bool Processor::has(const std::string& feature) const {
  return std::find(features.begin(), features.end(), feature) != features.end();
}

namespace {

#ifdef __x86_64__

std::string brand() {
  constexpr unsigned kFirst = 0x80000002;  // three leaves of sixteen characters
  std::array<unsigned, 12> words{};
  for (unsigned i = 0; i < 3; ++i)
    __get_cpuid(kFirst + i, &words[4 * i], &words[4 * i + 1], &words[4 * i + 2], &words[4 * i + 3]);
  std::string text(reinterpret_cast<const char*>(words.data()), sizeof words);
  text.resize(std::min(text.find('\0'), text.size()));
  const auto begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "unknown"
                                    : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

// The compiler's own reading of CPUID, and of the registers that the system keeps by XGETBV.
Processor read_processor() {
  __builtin_cpu_init();
  const std::pair<const char*, int> features[] = {
      {"sse3", __builtin_cpu_supports("sse3")},
      {"ssse3", __builtin_cpu_supports("ssse3")},
      {"sse4_1", __builtin_cpu_supports("sse4.1")},
      {"sse4_2", __builtin_cpu_supports("sse4.2")},
      {"avx", __builtin_cpu_supports("avx")},
      {"f16c", __builtin_cpu_supports("f16c")},
      {"fma", __builtin_cpu_supports("fma")},
      {"avx2", __builtin_cpu_supports("avx2")},
      {"bmi1", __builtin_cpu_supports("bmi")},
      {"bmi2", __builtin_cpu_supports("bmi2")},
      {"avx_vnni", __builtin_cpu_supports("avxvnni")},
      {"avx512f", __builtin_cpu_supports("avx512f")},
      {"avx512dq", __builtin_cpu_supports("avx512dq")},
      {"avx512cd", __builtin_cpu_supports("avx512cd")},
      {"avx512bw", __builtin_cpu_supports("avx512bw")},
      {"avx512vl", __builtin_cpu_supports("avx512vl")},
      {"avx512_vnni", __builtin_cpu_supports("avx512vnni")},
      {"avx512_bf16", __builtin_cpu_supports("avx512bf16")},
      {"avx512_fp16", __builtin_cpu_supports("avx512fp16")},
      {"amx_tile", __builtin_cpu_supports("amx-tile")},
  };
  Processor read{.brand = brand(), .features = {}};
  for (const auto& [name, is_there] : features)
    if (is_there != 0) read.features.emplace_back(name);
  return read;
}

#else

Processor read_processor() { return {.brand = "unknown", .features = {}}; }

#endif

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
  // Threads that wait actively for the next of many short tasks take the time of those that work.
  if (setting("OMP_WAIT_POLICY").empty()) wanted.emplace_back("OMP_WAIT_POLICY", "passive");
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

// libgomp pins the process that loads it to one place, and all that this process starts with it.
// Its places together are the processors that it found, or that were asked for.
bool unpin() {
  std::string set;
  for (const char* variable : {"OMP_PROC_BIND", "OMP_PLACES", "GOMP_CPU_AFFINITY"}) {
    const std::string value = setting(variable);
    if (!value.empty() && strcasecmp(value.c_str(), "false") != 0) set.append(" ").append(variable);
    unsetenv(variable);
  }
  if (set.empty()) return false;
  cpu_set_t all;
  CPU_ZERO(&all);
  for (int place = 0; place < omp_get_num_places(); ++place) {
    std::vector<int> processors(static_cast<std::size_t>(omp_get_place_num_procs(place)));
    omp_get_place_proc_ids(place, processors.data());
    for (const int one : processors) CPU_SET(static_cast<std::size_t>(one), &all);
  }
  if (CPU_COUNT(&all) > 0) sched_setaffinity(0, sizeof all, &all);
  say(stderr, "isoline: ignores" + set +
                  ", which would put all cells on one core; taskset limits the processors of a "
                  "run\n");
  return true;
}

// OpenBLAS ignores the name of a kernel that it does not know.
void warn_of_kernel() {
  const std::string asked = setting(kKernel), used = openblas_get_corename();
  if (!asked.empty() && strcasecmp(asked.c_str(), used.c_str()) != 0)
    say(stderr, "isoline: OPENBLAS_CORETYPE=" + asked +
                    " has no effect: OpenBLAS uses its kernel " + used + "\n");
}

// oneDNN computes blocks for which it has no kernel by its reference, a hundred times as slow and
// with other bits; and takes fewer instructions than were asked for where the processor has fewer.
void settle_convolutions() {
  for (const char* variable : {"ONEDNN_MAX_CPU_ISA", "DNNL_MAX_CPU_ISA"}) {
    std::string asked = setting(variable);
    std::ranges::transform(asked, asked.begin(), [](unsigned char c) { return std::toupper(c); });
    if (!has_fast_convolutions(asked)) {
      say(stderr,
          fmt::format("isoline: ignores {}={}: the convolutions of this build need AVX-512, "
                      "and would be a hundred times as slow\n",
                      variable, asked));
      unsetenv(variable);
    } else if (asked.starts_with("AVX") && asked != convolution_instructions()) {
      say(stderr, fmt::format("isoline: {}={} has no effect: oneDNN uses {}\n", variable, asked,
                              convolution_instructions()));
    }
  }
}

}  // namespace

const Processor& processor() {
  static const Processor read = read_processor();
  return read;
}

void prepare_libraries(char** arguments) {
  Eigen::setCpuCacheSizes(kCacheSizes.l1, kCacheSizes.l2, kCacheSizes.l3);
  bool is_set = !unpin();
  for (const auto& [variable, value] : wanted_environment()) {
    is_set = is_set && setting(variable) == value;
    setenv(variable, value.c_str(), 1);
  }
  if (!is_set) execv("/proc/self/exe", arguments);  // on failure we go on, with idle threads
  warn_of_kernel();
  settle_convolutions();
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
