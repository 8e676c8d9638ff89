// The record of one run, schema isoline.run/1: the request, the build, and the results. One JSON
// file each. Reports read nothing else about a run.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/foreign/foreign.h"
#include "core/oracle.h"
#include "core/real.h"
#include "core/records/parts.h"
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

// When each of 51 targets τ = 10^(−j/5) was first reached: f ≤ f_L + τ s, or the error in x
// ≤ max(τ‖x*‖, 1.1 x_floor), at any evaluated point. −1: never.
struct Hits {
  std::vector<Real> target;
  std::vector<std::int64_t> iteration, work, forwards;
  std::map<std::string, std::vector<std::int64_t>> counts, rounds;  // as the curve's
  std::vector<Real> wall_seconds;                                   // nan: never
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

// With `Parts`, each optional: what runs of some kinds keep beyond the curve.
struct Record : Parts {
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
  std::optional<Real> noise_level;  // δ, the expected ‖y* − P(x*)‖, where it is known
  std::map<std::string, std::optional<bool>> found;  // by τ: error in x ≤ max(τ‖x*‖, 1.1 x_floor)
  std::string criterion;  // digest of what success is measured by; older: none
  OracleCounts counts{};
  OracleCounts prices{};
  Summary summary;
  Curve curve;
  std::optional<Hits> hits;    // where f_L is declared
  std::optional<Hits> x_hits;  // of a direct problem that is judged by x; older: none
  std::map<std::string, std::vector<Real>> series;  // a problem's own quantities, as the curve
  std::vector<std::string> privileges;
  ForeignParts foreign;
  bool is_nondeterministic = false;       // ended by a clock or a kill
  std::vector<Real> repeat_wall_seconds;  // one a run of this very cell and build, sorted
  Provenance provenance;
  std::optional<Imported> imported;  // of a run that others made: its figures are their claims

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
// The paths of what it leaves out, such as "summary/wall_seconds".
const std::set<std::string>& paths_beside_results();
// Each member without these paths as json_text() prints it, "name":value, which takes no tree.
std::map<std::string, std::string> member_texts(const Record& record,
                                                const std::set<std::string>& left_out);

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
