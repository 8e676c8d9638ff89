// The data that a run writes while it runs: plain data of fixed size, so that it can live in memory
// shared between processes and be read after a crash. `points` and `hits` grow; what they already
// hold never changes, but for the last point, which the returned one replaces at the same
// iteration.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
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

// When the j-th target was first reached: f ≤ f_L + τ_j s.
struct TraceHit {
  std::int64_t iteration = -1, work = 0;  // iteration −1: never
  OracleCounts counts{};
  Rounds rounds{};
  double wall_seconds = 0;
};

struct Trace {
  static constexpr int kPoints = 512;  // iterations 0-100, then 32 a decade: enough for 1e14
  static constexpr int kInputs = 3, kOutputs = 16;  // largest x and y with a stored path
  static constexpr int kSeries = TracePoint::kSeries;
  static constexpr int kExhibit = 4096;  // numbers of each array of the exhibit
  static constexpr int kText = 1024;

  std::atomic<std::int64_t> first_oracle_nanoseconds{0};  // CLOCK_MONOTONIC; 0: not yet
  std::atomic<bool> is_finished{false};
  std::atomic<int> points{0};
  TracePoint point[kPoints];
  TraceHit hit[kRungs];
  double path_x[kPoints][kInputs], path_y[kPoints][kOutputs];
  int path_inputs = 0, path_outputs = 0;  // sizes of x and y in the path; 0: not kept

  // The results of a network on some validation samples, one per column.
  struct Exhibit {
    int rows = 0, columns = 0;
    double value[kExhibit];
  };
  Exhibit shown_target, shown_x, shown_truth;
  // y*, x* and x of the first sample that judges, where x and y are fields (core/frames.h), in the
  // single precision that files keep.
  struct Frames {
    static constexpr std::size_t kPlaces = 12;
    static constexpr int kCells = 128 * 128;  // of the largest grid
    int rows = 0, columns = 0;                // 0: nothing is kept
    bool has_truth = false, has_context = false, has_y = false;
    std::int64_t iteration[kPlaces];  // −1: nothing there
    float target[kCells], truth[kCells], x[kPlaces][kCells];
    float y[kCells], context[kCells];  // y of the last x

    Frames() { std::fill_n(iteration, kPlaces, -1); }
  };
  Frames frames;
  // Singular values of J = ∂y/∂θ over the batch of a step, at some kept iterations, if requested.
  struct Spectra {
    static constexpr int kPlaces = 48;    // iterations 0, 1, 2, 4, 8, …, and the last
    static constexpr int kValues = 2048;  // of one spectrum
    bool are_wanted = false;
    int values = 0, taken = 0;
    std::int64_t iteration[kPlaces];
    double sigma[kPlaces][kValues];  // descending
  };
  Spectra spectra;
  // x at the returned point of a direct least-squares problem with more residuals than unknowns,
  // and its covariance σ̂² (JᵀJ)⁻¹ as standard deviations and correlations.
  struct Uncertainty {
    static constexpr int kUnknowns = 64;
    int unknowns = 0;  // 0: nothing is kept
    std::int64_t degrees_of_freedom = 0;
    double variance, condition;  // σ̂²; of J, its columns scaled to norm 1
    double x[kUnknowns], deviation[kUnknowns], correlation[kUnknowns][kUnknowns];
  };
  Uncertainty uncertainty;
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
  // θ = x of a direct problem: where the loss was least of all that was evaluated, and as it was
  // returned, with ‖y − y*‖ there.
  struct Answer {
    static constexpr int kUnknowns = 128 * 128;
    int unknowns = 0;  // 0: nothing is kept
    bool has_best = false, has_returned = false;
    double residual_norm;
    double best[kUnknowns], returned[kUnknowns];
    bool is_bounded = false;
    double lower[kUnknowns], upper[kUnknowns];  // of x, infinite where there is no bound
    bool is_scaled = false;
    double scale[kUnknowns];  // where it is: x = scale · θ, within the bounds
    static constexpr int kNames = 16 * 1024;
    char names[kNames] = "";  // of the unknowns: NAME, tab, UNIT, a line each; empty: x1, x2, …
  };
  Answer answer;
  FailedEvaluations failures;
  // x at both points of the answer of a problem with the words of a model, where it is not θ; names
  // and bounds are then of x.
  struct ModelAnswer {
    static constexpr int kUnknowns = 256;
    int unknowns = 0;  // 0: there is no model
    double best[kUnknowns], returned[kUnknowns];
  };
  ModelAnswer model_answer;
  // The data of a fit, and y at the returned point, in the units of the data.
  struct Fit {
    static constexpr int kData = 4096;
    int data = 0;  // 0: nothing is kept
    bool has_sigma = false;
    double target[kData], y[kData], sigma[kData];
  };
  Fit fit;
  CallReport calls;
};

// The part that fits, cut at a character.
void set_text(char (&out)[Trace::kText], std::string_view text);

// The error in a trace that another process may have overwritten; empty if the trace is valid:
// every count, size, choice and text is in its range, so that readers need no checks of their own.
std::string defect_of(const Trace& trace);

}  // namespace isoline
