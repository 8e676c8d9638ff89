// The record of one run, schema isoline.run/1: the request, the build, and the results. One JSON
// file each. Reports read nothing else about a run.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/foreign/foreign.h"
#include "core/oracle.h"
#include "core/real.h"
#include "core/records/provenance.h"
#include "core/records/request.h"
#include "core/status.h"

namespace isoline {

// The origin of an imported record: a curve that others computed, with their own statements.
struct Imported {
  std::string source;   // the origin: a paper and its figure, a repository, a person
  std::string program;  // the program that computed it, with its version
  std::string curve;    // the name of the file
  std::string sha256;   // digest of that file
};

// The curve as columns of equal length.
struct Curve {
  std::vector<std::int64_t> iteration, work;
  std::map<std::string, std::vector<std::int64_t>> counts;  // by oracle, of those that were called
  // By number of workers (kWorkers); empty where the work is more than forward solves.
  std::map<std::string, std::vector<std::int64_t>> rounds;
  std::vector<Real> wall_seconds, processor_seconds, loss, x_error, gradient_norm, step_norm;
  std::vector<Real> kkt_residual, discrepancy;  // empty without bounds, and without known noise
  // For learning problems, by window: the means over the training batches of the last steps.
  std::map<std::int64_t, std::vector<Real>> batch_loss, batch_x_error;
};

// When each of 51 targets τ = 10^(−j/5) was first reached: f ≤ f_L + τ s. −1: never.
struct Hits {
  std::vector<Real> target;
  std::vector<std::int64_t> iteration, work, forwards;
  std::map<std::string, std::vector<std::int64_t>> counts, rounds;  // as the curve's
  std::vector<Real> wall_seconds;                                   // nan: never
};

// The path in x and y, at the iterations of the curve; where x and y are small.
struct Trajectory {
  std::vector<std::vector<Real>> x, y;
};

// The results of a learning run on some validation samples, one per column.
struct Exhibit {
  Grid target, x, truth;
};

// x of a run at some of its kept iterations, where x and y are numbers on one grid of cells. The
// numbers stand beside the record, in CELL-BUILD.npy: float32 of the shape (planes, rows, columns),
// which are y*, x* where it is known, x by iteration and, beside x*, y of the last x and the
// context.
struct FieldFrames {
  std::vector<std::int64_t> iterations = {};
  std::vector<Index> shape = {};
  std::string digest;               // of the file
  std::vector<float> numbers = {};  // as the file has them; empty where they are still there

  bool has_truth() const { return others() > 1; }
  bool has_y() const { return others() > 2; }
  bool has_context() const { return others() > 3; }
  std::span<const float> target() const { return plane(0); }  // row by row
  std::span<const float> truth() const { return plane(1); }
  std::span<const float> x(std::size_t i) const { return plane(i + (has_truth() ? 2 : 1)); }
  std::span<const float> y() const { return plane(iterations.size() + 2); }
  std::span<const float> context() const { return plane(iterations.size() + 3); }
  bool operator==(const FieldFrames& other) const {  // the digest stands for the numbers
    return iterations == other.iterations && shape == other.shape && digest == other.digest;
  }

 private:
  Index others() const { return shape[0] - static_cast<Index>(iterations.size()); }
  std::span<const float> plane(std::size_t i) const {
    const auto cells = static_cast<std::size_t>(shape[1] * shape[2]);
    return std::span(numbers).subspan(i * cells, cells);
  }
};
void require_sound(const FieldFrames& frames);  // UsageError where iterations and shape disagree
std::string field_file(const FieldFrames& frames);  // the file's bytes
inline std::filesystem::path field_path(std::filesystem::path record) {
  return record.replace_extension(".npy");
}
// The numbers out of the file; UsageError, naming it, where it is missing, is damaged or is another
// run's.
void read_field_numbers(FieldFrames& frames, const std::filesystem::path& path);

// Singular values of J = ∂y/∂θ over the batch of a step, descending, if --spectrum was set. Without
// iterations: J is not formed, or too large.
struct Spectrum {
  std::vector<std::int64_t> iterations = {};
  std::vector<std::vector<Real>> sigma = {};  // one spectrum an iteration

  bool operator==(const Spectrum&) const = default;
};

// A direct least-squares problem with more residuals than unknowns: x as it was returned, and
// its covariance σ̂² (JᵀJ)⁻¹ there, σ̂² = ‖y − y*‖²/(m − n), as standard deviations and correlations.
struct Uncertainty {
  std::vector<Real> x, standard_deviation;
  std::vector<std::vector<Real>> correlation;
  Real variance = 0;                    // σ̂²
  std::int64_t degrees_of_freedom = 0;  // m − n
  Real condition = 0;                   // number of J, its columns scaled to norm 1
};

// The noise of y in a call, by differences, relative to ‖y‖, and the step that followed from
// it, relative to the sizes of the unknowns; none where the options give the steps.
struct Differences {
  Real noise = 0;
  std::optional<Real> step;
};

// θ = x of a direct problem, which is what its user wants: as the run returned it, and the point of
// least loss where that is another one. Beyond kInline unknowns, the numbers stand beside the
// record in CELL-BUILD.x.npy: float64 of the shape (points, unknowns).
struct AnswerPoints {
  static constexpr std::size_t kInline = 1000;
  Index unknowns = 0;
  std::vector<std::string> names = {};    // (unknowns); empty: x1, x2, …
  std::vector<std::string> units = {};    // (unknowns), each may be empty; empty: none has one
  std::vector<std::string> points = {};   // kReturned, kBest or both
  std::vector<std::vector<Real>> x = {};  // (points, unknowns); empty where the file has them
  // Unknowns, from 0, that lie on such a bound at the point of least loss.
  std::vector<Index> at_lower = {}, at_upper = {};
  std::vector<Real> scales = {};           // (unknowns), by which methods saw x divided; empty: 1
  std::optional<Real> residual_norm = {};  // ‖y − y*‖ at the returned point
  std::string digest = {};                 // of the file, if there is one

  // The numbers of that point; nothing where it is not kept, or where they are not read.
  std::span<const Real> point(const char* name) const {
    for (std::size_t i = 0; i < x.size(); ++i)
      if (points[i] == name) return x[i];
    return {};
  }
  bool is_in_file() const { return !digest.empty(); }
  std::string name(std::size_t i) const {
    return i < names.size() ? names[i] : "x" + std::to_string(i + 1);
  }
  std::string unit(std::size_t i) const { return i < units.size() ? units[i] : ""; }
  bool is_bound_active() const { return !at_lower.empty() || !at_upper.empty(); }
  const char* bound(std::size_t i) const {  // "lower" or "upper", if x lies on one
    const auto has = [&](const std::vector<Index>& all) {
      return std::find(all.begin(), all.end(), static_cast<Index>(i)) != all.end();
    };
    return has(at_lower) ? "lower" : has(at_upper) ? "upper" : "";
  }
};
inline constexpr const char *kReturned = "returned", *kBest = "best";
void require_sound(const AnswerPoints& answer);       // UsageError where sizes or names disagree
std::string answer_file(const AnswerPoints& answer);  // the file's bytes
inline std::filesystem::path answer_path(std::filesystem::path record) {
  return record.replace_extension(".x.npy");
}
// The numbers out of the file, if there is one; UsageError, naming it, where it is missing, is
// damaged or is another run's.
void read_answer_numbers(AnswerPoints& answer, const std::filesystem::path& path);

// The data of a user's own program, or of a problem with the words of a model, and y at the
// returned point, in the units of the data.
struct FitData {
  std::vector<Real> target, y;
  std::vector<Real> sigma = {};  // standard deviations; empty where they are unknown
};

// Evaluations that failed, because the simulator did or its y was not finite: how many, and of the
// first ones x and the reason.
struct Failures {
  std::int64_t total = 0;
  std::vector<std::vector<Real>> x = {};
  std::vector<std::string> reasons = {};  // one for each x
};

// Calls of a run to the program that computes its problem, and those by which a verifier computed
// the returned point again.
struct Calls {
  std::int64_t made = 0, answered = 0;  // answered by the store of evaluations
  std::int64_t verified = 0, failed = 0;
};

// The parts of a run that other programs computed.
struct ForeignParts {
  std::optional<Foreign> problem = {}, optimizer = {};

  bool empty() const { return !problem && !optimizer; }
};

struct Summary {
  std::int64_t iterations = 0, work = 0, rejected_steps = 0;
  Real start_loss = 0, loss = 0, best_loss = 0;
  Real start_x_error = 0, x_error = 0, gradient_norm = 0;
  Real wall_seconds = 0, processor_seconds = 0;
  std::int64_t peak_memory_bytes = 0;
};

inline std::string record_file_name(const std::string& cell, const std::string& build) {
  return cell + "-" + build + ".json";
}

struct Record {
  std::string cell, build;  // digests
  BuildParts build_parts;   // digests of what `build` is of; older records lack them
  Request request;
  Status status = Status::running;
  std::string message;
  std::string output;           // what it wrote to its terminal, where that was kept
  std::string claimed;          // what the method said of its own success
  Aim aim = Aim::loss;          // what its user wants: headlines count that
  std::optional<Real> minimum;  // f_L: declared, else the best known
  bool is_best_known = false;   // f_L is the best loss known, which a run may better
  std::optional<Real> scale;    // s = min(f₀ − f_L, the problem's scale)
  std::map<std::string, std::optional<bool>> verified;  // by τ: f − f_L ≤ τ s at the returned point
  // The scales of errors in x, if a solution is known: ‖x*‖, and the floor that the data impose.
  std::optional<Real> x_scale;
  Real x_floor = 0;
  std::optional<Differences> differences;  // by which J came
  std::optional<Real> noise_level;         // δ, the expected ‖y* − P(x*)‖, where it is known
  std::map<std::string, std::optional<bool>> found;  // by τ: error in x ≤ max(τ‖x*‖, 1.1 x_floor)
  std::string criterion;  // digest of what success is measured by; older: none
  OracleCounts counts{};
  OracleCounts prices{};
  Summary summary;
  Curve curve;
  std::optional<Hits> hits;  // where f_L is declared
  std::optional<Trajectory> trajectory;
  std::map<std::string, std::vector<Real>> series;  // a problem's own quantities, as the curve
  std::optional<Exhibit> exhibit;
  std::optional<FieldFrames> fields;  // of a problem on a grid
  std::optional<Spectrum> spectrum;
  std::optional<Uncertainty> uncertainty;
  std::vector<std::string> privileges;
  ForeignParts foreign;
  bool is_nondeterministic = false;       // ended by a clock or a kill
  std::vector<Real> repeat_wall_seconds;  // one a run of this very cell and build, sorted
  Provenance provenance;
  std::optional<Imported> imported;    // of a run that others made: its figures are their claims
  std::optional<AnswerPoints> answer;  // of a direct problem
  std::optional<FitData> fit;          // of the user's own problem
  std::optional<Failures> failures;    // where any evaluation failed
  std::optional<Calls> calls;          // to a problem of another program

  std::string file_name() const { return record_file_name(cell, build); }
};

Json to_json(const Record& record);
std::string file_text(const Record& record);
// UsageError where it is no such record, or its columns differ in length; the origin is named where
// it is no JSON.
Record record_from_text(const std::string& text, const std::string& origin);
// UsageError, which names it, also where the record breaks an invariant.
Record read_record(const std::string& path);
// The invariants are not checked: for comparisons and repetitions, which name what is broken.
Record read_unchecked_record(const std::string& path);

Json run_schema();  // what benchmarks/schemas/run.json holds

// The part of a record that must be equal in two runs of one build. Fields and spectra are not,
// since only one of the runs may keep them.
Json result_of(const Json& record);

// The record without everything that may differ between two runs of one build: times, memory,
// concurrency, fields and spectra.
Json without_timings(Json record);

inline constexpr const char* kRunSchema = "isoline.run/1";

// τ of `verified` and `found`, by its name in the record.
inline const std::map<std::string, Real> kVerified = {
    {"1e-1", 1e-1}, {"1e-3", 1e-3}, {"1e-6", 1e-6}};

// Whether a record agrees with itself: its success criterion, and the figures that follow from
// other figures of the same record. A change by hand, or a fault of the program, breaks them.

// The criterion by which a run succeeded, and the costs in which its work is counted.
struct Criterion {
  std::optional<Real> minimum, scale, x_scale;  // f_L, s and ‖x*‖, where they are known
  Real x_floor = 0;
  Aim aim = Aim::loss;
  OracleCounts prices{};  // nominal costs

  bool operator==(const Criterion&) const = default;
};
Criterion criterion_of(const Record& record);
std::string digest_of(const Criterion& criterion);  // what `Record::criterion` holds

// A sentence for each invariant that the record breaks; none of a sound one. Of a run that broke
// off, or that others made, fewer hold.
std::vector<std::string> broken_invariants(const Record& record);

}  // namespace isoline
