// Chooses one option of each pair of problem and optimizer over a grid, with an equal budget for
// all, on seeds that are used for tuning only. Keeps all results of the grid.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/run_plan.h"
#include "core/records/record.h"

namespace isoline::benchmarks {

using Json = nlohmann::json;

// The option that is tuned for a pair of problem and optimizer: the method's tunable option, or
// that of the gradient rule inside its network-optimizer, if the problem has a network to train.
struct Knob {
  std::string option;
  std::string rule;  // the name of that gradient rule; empty: the option is the method's own
  Real standard = 1;
  Range range;
  bool is_whole = false;
  optimizers::Tunable tunable;  // the tunable option of the method
};

// The tunable option of a method, if it has one. `given` are options that the pair has anyway.
std::optional<Knob> knob_of(const Catalog& catalog, const std::string& optimizer,
                            const Component& problem, const OptionValues& given);

// The options of the pair with the knob set.
OptionValues with_value(const Knob& knob, OptionValues given, Real value);

inline constexpr int kGridValues = 7, kMostExtensions = 3;

// Seven values, ascending, each `factor` times the one before but for the default, which stands in
// the place of the value next to it. `unit` is what the values are multiples of.
std::vector<Real> grid_of(const Knob& knob, Real unit);
// The same for all problems: in the option's own unit, values `factor`² apart, and at least two
// below the default, since it has to serve problems of any scale.
std::vector<Real> common_grid_of(const Knob& knob);
// The value beyond the last, or before the first; nothing where the option's range ends.
std::optional<Real> value_beyond(const Knob& knob, const std::vector<Real>& values, bool upward);

// A grid of one's own. "rate=1e-4..1e-1x4": four values from 1e-4 to 1e-1, evenly on a logarithmic
// axis.
struct GivenGrid {
  std::string option = "rate";
  std::vector<Real> values;  // in `unit`
  // "one"; "cauchy": the problem's Cauchy step; or "published": the pair's own value in the tables
  // that are not tuned.
  std::string unit = "one";
};
GivenGrid parse_grid(const std::string& text, const std::string& unit);

// The median work to τ = 1e-6 of what the problem's user wants, then the median of what was left at
// the end, the loss or the error in x; less is better.
struct TuningScore {
  Real work = std::numeric_limits<Real>::infinity();
  Real left = std::numeric_limits<Real>::infinity();
  bool operator==(const TuningScore&) const = default;
  bool operator<(const TuningScore& other) const {
    return work != other.work ? work < other.work : left < other.left;
  }
};

// From the runs of one value, one per seed. A diverged or failed run gives neither number, a
// learning problem the second alone, on its validation samples.
TuningScore score_of(const std::vector<Record>& runs);

// Which of the values is best. Ties go to the default, or to what is nearest to it on a logarithmic
// axis.
std::size_t best_value(const std::vector<Real>& values, const std::vector<TuningScore>& scores,
                       Real standard);

struct TunedPair {
  Component problem;
  std::string optimizer;  // a name
  Budget budget;
  OptionValues options = {};  // that it has anyway, as from a paper
};

// Every pair is tried at seven values of its method's option, and while the best stands at an edge
// at one more beyond it, three at most. A grid of one's own is for all pairs, and is not extended,
// nor is a method's common grid.
struct TuningPlan {
  std::vector<TunedPair> pairs = {};
  std::vector<std::uint64_t> seeds;
  std::optional<GivenGrid> grid = {};
  bool is_common = false;
};

// One pair's grid and what it came to.
struct TunedOption {
  std::string problem, optimizer, option;  // "rate", or "rate of adam" inside another method
  std::vector<Real> values = {};           // ascending
  std::vector<TuningScore> scores = {};
  std::size_t best = 0;
  bool is_at_edge = false;  // of the grid, and better than its neighbour
  std::string family = {};  // by the problem's operator
  Real standard = 1;        // the default
  std::int64_t work = 0;    // nominal, of all trials
};

// The value of a method's option for one family of problems, chosen by the scores on the others.
struct LeftOut {
  std::string family;
  const TunedOption* grid = nullptr;        // any of the method's: all have the same values
  std::vector<std::string> chosen_on = {};  // families
  std::vector<Real> scores = {};            // of each value: the mean over these families
  std::size_t best = 0;
  bool is_at_edge = false;
  std::int64_t work = 0;  // of all trials of the method
};

// For every family, by method and family. The score of a value on a setting is 1 − log2(work/least
// work of the method's values)/log2 64, at least 0, and 0 where it is not solved; the score on a
// family is the mean over its settings. Ties go to the default, or to what is nearest to it.
std::vector<LeftOut> leave_one_out(const std::vector<TunedOption>& tuned);

struct TuningResult {
  std::shared_ptr<const Json> rows;           // of a table isoline.rates/1
  std::shared_ptr<const Json> left_out_rows;  // of another, one per family; of a common grid
  std::vector<TunedOption> tuned;             // the same, one per row
  std::size_t inapplicable = 0;               // pairs without a row
  Outcome outcome;                            // runs and seconds are those of all rounds
};

// A row has the values, their scores, whether the best is at an edge, and the budget of
// work if it differs from that of the first pair. Inapplicable pairs have none; if every value
// failed, the one nearest to the default is used.
TuningResult tune(const Catalog& catalog, const TuningPlan& plan,
                  const std::filesystem::path& folder, const RunOptions& options);

}  // namespace isoline::benchmarks
