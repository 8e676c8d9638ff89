// What decides a claim, to be looked at: each term of its quantity as it was read, run by run, with
// the curve it was read off.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "reports/sections/agreement.h"
#include "reports/sections/claim_terms.h"

namespace isoline::reports {

struct EvidenceRun {
  std::string cell, file;  // the digest of what was asked; the name of the record
  std::uint64_t seed = 0;
  Real figure = 0;  // scaled
  Status status = Status::running;
};

// Of several alternatives the one that counts.
struct EvidenceTerm {
  std::string problem, optimizer;         // the optimizer as the claim writes it
  std::string method;                     // the optimizer's name alone
  Real at = 1, scale = 1;                 // its abscissa, and a factor of its figures
  std::optional<std::int64_t> iteration;  // where it is read; none: at the end
  Real read_at = 0;                       // the same on the axis of its curve
  Real level = 0;                         // the median of its figures
  std::vector<EvidenceRun> runs;
  // Its figure over iterations, or over seconds: the median over seeds with the least and the
  // greatest. Empty where it is of a whole run.
  std::vector<Real> x, y, low, high;
};

struct Evidence {
  std::string kind, column;   // of the quantity
  std::string curve;          // the column of the curves
  Real published = 0;         // of a table: no distance from it
  Agreement band;             // what agrees with that
  std::string abscissa;       // the option of the problem that is each term's, where there is one
  bool is_over_time = false;  // curves are over seconds of processor time
  std::vector<EvidenceTerm> terms;
  std::vector<PrintedRow> printed;  // of an equality: the figures, and those of the first run
};

// Of a claim, or of its contrast. `cells` and `iterations` are those of the set that decides it.
Evidence evidence_of(const nlohmann::json& claim, const nlohmann::json& cells, const ByCell& runs,
                     std::int64_t iterations);

// One of the lengths at which a claim can be decided.
struct CellSet {
  std::int64_t iterations = 0;
  std::size_t planned = 0, here = 0;  // cells, each once
  bool is_long = false;               // hours: run only when asked for
  bool is_deciding = false;
};
std::vector<CellSet> cell_sets(const nlohmann::json& claim, const ByCell& runs);

// Runs all that decides the claim anew, in a folder of its own.
std::string repeat_command(const std::string& id, const std::vector<CellSet>& sets);

}  // namespace isoline::reports
