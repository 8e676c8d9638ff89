// A cell of a result folder or of a baseline, in the one form in which two results are compared.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/options.h"
#include "core/records/record.h"
#include "core/results/statistics.h"
#include "core/results/study.h"
#include "core/status.h"
#include "core/threads.h"

namespace isoline::reports {

using namespace results;

enum class Quantity { loss, best_loss, x_error, path, work, work_to_x, unverified };

// Share of a problem's scale below which values are as good as solved.
inline constexpr Real kSmallestShare = 1e-6;

// Less is better.
struct ComparedFigure {
  Quantity quantity = Quantity::loss;
  std::size_t rung = 0;  // of work to a target, on the ladder
  Real value = kNever;
  Real scale = 0;  // of the problem: where rounding and what is too small to tell are measured from
};
std::string figure_name(const ComparedFigure& figure);  // "work to 1e-3"

// The results of runs that started one unit in the last place away.
struct Perturbed {
  Real moved = 0;                // the least tolerance within which all agree with the given start
  std::vector<Status> statuses;  // how each ended
  std::array<std::size_t, kTolerances.size()> reached{};  // of them, how many reached each target
};

// A problem or an optimizer as in a run's request; unknown parts are empty.
struct Given {
  std::string name;
  std::string asked;                                 // as typed: defaults and rates unfilled
  std::string spec;                                  // the name and what differs from the defaults
  std::shared_ptr<const OptionValues> options = {};  // all of them; cells share equal ones
};

struct ComparedCell {
  std::string key;    // what joins two results: the cell's digest
  std::string title;  // "heat × gd, seed 3"
  Given problem, optimizer;
  std::uint64_t seed = 0;
  std::string terms;  // budget and threads asked for
  Status status = Status::running;
  std::string build;
  std::shared_ptr<const BuildParts> parts;  // digests of its build's parts; none: unknown
  Aim aim = Aim::loss;
  std::optional<Criterion> criterion;   // of success; an older baseline does not hold it
  std::vector<std::string> privileges;  // known where the criterion is
  std::vector<ComparedFigure> figures;
  std::string trace, rest;  // digests of its path and of what else is deterministic
  std::vector<std::pair<std::string_view, std::uint64_t>> members;  // digests of that, by name
  std::vector<Real> seconds;                                        // repetitions
  std::size_t senseless_times = 0;  // of them, left out: infinite, or not a number
  std::string processor;
  bool is_cut = false;                 // a clock or a kill ended it
  std::string doubt;                   // why its record cannot be trusted; empty: it can
  std::optional<Perturbed> perturbed;  // where a baseline has measured it
};

int badness_of(Status status);                 // the greater the worse
bool is_lost(const ComparedCell& cell);        // it went wrong, or does not apply
Status status_named(const std::string& name);  // UsageError if it is unknown
std::string title_of(const ComparedCell& cell);
std::shared_ptr<const OptionValues> shared_options(const OptionValues& options);
std::shared_ptr<const BuildParts> shared_parts(const BuildParts& parts);
// The cost of a run until one of the targets, by a success criterion; infinite if it missed it.
Real work_to(const ComparedCell& cell, Aim aim, std::size_t rung);

std::vector<ComparedCell> compared_cells(const Study& study);

// A result folder, read record by record: a hundred thousand cells take a tenth of the memory of
// their curves.
struct FolderCells {
  std::vector<ComparedCell> cells;  // by problem, optimizer, seed
  std::size_t unreadable = 0, superseded = 0;
};

FolderCells read_cells(const std::string& folder,  // UsageError if it does not exist
                       const Listener& listener = {});

}  // namespace isoline::reports
