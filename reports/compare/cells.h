// A cell of a result folder or of a baseline, in the one form in which two results are compared.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/records/integrity.h"
#include "core/records/record.h"
#include "core/results/study.h"
#include "core/results/targets.h"
#include "core/threads.h"

namespace isoline::reports {

using namespace results;

// Share of a problem's scale below which values are as good as solved.
inline constexpr Real kSmallestShare = 1e-6;

// The figures of a cell that are compared. Less is better.
inline constexpr std::size_t kLoss = 0, kBestLoss = 1, kPath = 2, kXError = 3, kWork = 4,
                             kWorkToX = kWork + kTargets,
                             kUnverified = kWorkToX + kTolerances.size(),
                             kFigures = kUnverified + 1;
struct FigureKind {
  const char *key, *name;        // in a baseline; as shown
  std::size_t first, count = 1;  // its figures
};
inline constexpr FigureKind kFigureKinds[] = {
    {"loss", "loss", kLoss},
    {"best_loss", "best loss", kBestLoss},
    {"path", "mean loss of the path", kPath},
    {"x_error", "error in x", kXError},
    {"work", "work to ", kWork, kTargets},
    {"found", "work to an error in x of ", kWorkToX, kTolerances.size()},
    {"unverified", "targets missed by the last point", kUnverified}};
std::string figure_name(std::size_t figure);  // "work to 1e-3"
// The figure of one of the tolerances of the tables; the work in the sense of loss or of x.
constexpr std::size_t work_at(Aim aim, std::size_t tolerance) {
  return aim == Aim::x ? kWorkToX + tolerance : kWork + kTolerances[tolerance].rung;
}

// The results of runs that started one unit in the last place away.
struct Perturbed {
  Real moved = 0;                // the least tolerance within which all agree with the given start
  std::vector<Status> statuses;  // how each ended
  std::array<std::size_t, kTolerances.size()> reached{};  // of them, how many reached each target
};

struct ComparedCell {
  std::string key;    // the cell's digest
  std::string title;  // "heat × gd, seed 3"
  // As asked (of older records as given) and as given, with all options; cells share equal ones.
  std::shared_ptr<const Component> problem, optimizer;
  std::uint64_t seed = 0;
  std::string terms;  // budget and threads asked for
  Status status = Status::running;
  std::string build;
  std::shared_ptr<const BuildParts> parts;  // digests of its build's parts; none: unknown
  Criterion criterion = {};                 // of success
  std::vector<std::string> privileges;
  std::vector<Real> figures;    // (kFigures); not-a-number: unknown. Empty: none
  Real scale = 0, x_scale = 0;  // of its losses and of its error in x
  std::string trace, rest;      // digests of its path and of what else is deterministic
  std::vector<std::pair<std::string_view, std::uint64_t>> members;  // digests of that, by name
  std::vector<Real> seconds;                                        // repetitions
  std::size_t senseless_times = 0;  // of them, left out: infinite, or not a number
  std::string processor;
  bool is_cut = false;                 // a clock or a kill ended it
  std::string doubt;                   // why its record cannot be trusted; empty: it can
  std::optional<Perturbed> perturbed;  // where a baseline has measured it

  bool has(std::size_t figure) const { return !figures.empty() && !std::isnan(figures[figure]); }
};

std::vector<ComparedCell> compared_cells(const Study& study);

// A result folder, read record by record: a hundred thousand cells take a tenth of the memory of
// their curves.
struct FolderCells {
  std::vector<ComparedCell> cells;  // by problem, optimizer, seed
  std::size_t unreadable = 0, superseded = 0;
};
FolderCells read_cells(const std::string& folder,  // UsageError if it does not exist
                       const Listener& listener = {});

// The reference of a gate: one line per cell, small enough to be kept in a repository. It keeps
// what is compared bit for bit (status, build, digest of the trace, final figures, work to the
// tolerances of the tables), with what was asked, given and built, and neither curves nor times.
// `perturbed` holds runs of the same cells from starts perturbed in the last bit, a study a
// perturbation: how far they moved is kept.
inline constexpr const char* kBaselineSchema = "isoline.baseline/1";
std::string baseline_json(const Study& study, const std::vector<Study>& perturbed = {});
std::vector<ComparedCell> baseline_from_json(const Json& json);  // UsageError if it is not valid

// Pieces that records and baselines share.
std::string title_of(const ComparedCell& cell);
Json component_json(const Component& component);
std::shared_ptr<const Component> shared_component(const Component& component);
std::shared_ptr<const BuildParts> shared_parts(const BuildParts& parts);

}  // namespace isoline::reports
