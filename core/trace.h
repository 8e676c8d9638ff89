// The data that a run writes while it runs: plain data of fixed size, so that it can live in memory
// shared between processes and be read after a crash. `points` and `hits` grow; what they already
// hold never changes, but for the last point, which the returned one replaces at the same
// iteration.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

#include "core/calls.h"
#include "core/failures.h"
#include "core/oracle.h"
#include "core/status.h"

namespace isoline {

// The numbers of workers for which a run counts rounds: s forward solves that a method hands over
// together take ⌈s/W⌉ of them, and all other work as many as its nominal cost.
inline constexpr std::array<std::int64_t, 2> kWorkers = {8, 64};
using Rounds = std::array<std::int64_t, kWorkers.size()>;

struct TracePoint {
  std::int64_t iteration = 0;
  OracleCounts counts{};  // cumulative
  std::int64_t work = 0;  // counts times nominal costs
  Rounds rounds{};        // cumulative
  double wall_seconds = 0, processor_seconds = 0;
  double loss = 0;
  double x_error = 0;        // distance to the nearest solution; nan where none is known
  double gradient_norm = 0;  // ‖∂L/∂θ‖; nan where the problem has none
  double kkt_residual = kAbsent;  // ‖θ − Π(θ − ∂L/∂θ)‖, Π onto the bounds; nan without bounds
  double discrepancy = kAbsent;  // ‖y − y*‖ of the data; nan where their noise is not known
  double step_norm = 0;          // ‖θ − θ at the previous iteration‖
  // For learning problems: the means over the batches of the last 64 and 256 steps, each taken
  // before its step; nan elsewhere.
  double batch_loss[2] = {kAbsent, kAbsent}, batch_x_error[2] = {kAbsent, kAbsent};
  // Named quantities of the problem, then of the method.
  static constexpr int kSeries = 24;
  double series[kSeries];

  static constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
  static constexpr std::int64_t kWindows[2] = {64, 256};

  TracePoint() { std::fill_n(series, kSeries, kAbsent); }
};

// When the j-th target was first reached: f ≤ f_L + τ_j s, or an error in x of at most the goal at
// τ_j.
struct TraceHit {
  std::int64_t iteration = -1, work = 0;  // iteration −1: never
  OracleCounts counts{};
  Rounds rounds{};
  double wall_seconds = 0;
};

struct Trace {
  static constexpr int kPoints = 512;  // iterations 0-100, then 32 a decade: enough for 1e14
  static constexpr int kSeries = TracePoint::kSeries;
  static constexpr int kText = 1024;

  std::atomic<std::int64_t> first_oracle_nanoseconds{0};  // CLOCK_MONOTONIC; 0: not yet
  std::atomic<bool> is_finished{false};
  std::atomic<int> points{0};
  TracePoint point[kPoints];
  TraceHit hit[kRungs], x_hit[kRungs];  // the latter of a direct problem that is judged by x
  bool is_learned = false;
  char series_names[kText] = "";  // a line each

  // The last state known, kept up to date at every iteration; the final verdict when finished.
  TracePoint last;
  OracleCounts prices{};
  bool counts_rounds = false;  // all work is forward solves of a direct problem
  Aim aim = Aim::loss;
  double minimum = std::numeric_limits<double>::quiet_NaN();  // f_L; nan where undeclared
  double scale = std::numeric_limits<double>::quiet_NaN();  // s; nan where f_L is, or none is known
  double x_scale = std::numeric_limits<double>::quiet_NaN();  // nan where no solution is known
  double x_floor = 0;
  double noise_level = std::numeric_limits<double>::quiet_NaN();  // δ; nan where not known
  // The noise of y in a call by the last differences, relative to ‖y‖, and their step, relative
  // to the sizes of the unknowns; nan: J is not by differences.
  double difference_noise = std::numeric_limits<double>::quiet_NaN();
  double difference_step = std::numeric_limits<double>::quiet_NaN();
  bool is_bounded = false;
  double start_loss = std::numeric_limits<double>::quiet_NaN();
  double best_loss = std::numeric_limits<double>::infinity();
  double start_x_error = std::numeric_limits<double>::quiet_NaN();
  std::int64_t rejected_steps = 0;
  std::int64_t peak_memory_bytes = 0;
  Status status = Status::running;
  bool stopped_by_clock = false;  // the soft time limit ended it: not reproducible
  char message[kText] = "";
  char privileges[kText] = "";  // what the method saw that others do not, a line each
  char claimed[kText] = "";     // what the method says of its own success, in its words
  // θ of a direct problem where the loss was least of all that was evaluated; not of larger ones.
  static constexpr int kUnknowns = 128 * 128;
  int unknowns = 0;  // 0: nothing is kept
  bool has_best = false;
  double best[kUnknowns];
  FailedEvaluations failures;
  CallReport calls;
  // The data of keepers (benchmarks/run/keepers), each in its place, once they are there.
  bool wants_spectra = false, has_kept = false;
  static constexpr std::size_t kKept = std::size_t{3} << 20;
  alignas(64) std::byte kept[kKept];
};

// A byte that is neither 0 nor 1 must not be read as a bool.
template <class Flag>
bool is_flag(const Flag& flag) {
  static_assert(sizeof flag == 1);
  unsigned char byte = 0;
  std::memcpy(&byte, reinterpret_cast<const unsigned char*>(&flag), 1);
  return byte <= 1;
}
inline bool is_within(int value, int most) { return value >= 0 && value <= most; }

// The part that fits, cut at a character.
void set_text(char (&out)[Trace::kText], std::string_view text);

// The error in a trace that another process may have overwritten; empty if the trace is valid:
// every count, size, choice and text is in its range, so that readers need no checks of their own.
std::string defect_of(const Trace& trace);

}  // namespace isoline
