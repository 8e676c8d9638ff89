// Writes component metadata, and measures the costs in them. One measurement is a forward solve at
// a new point and one call of the oracle after it, timed separately; a round is many such pairs on
// its own work space. The cost is the ratio of the two medians, so that neither a drift of the
// machine nor other load matters, and nothing is subtracted. The call includes everything that it
// has to prepare at a new point.
#include "benchmarks/run/sheets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/plan/build_parts.h"
#include "benchmarks/run/interrupts.h"
#include "benchmarks/run/isolate.h"
#include "core/clock.h"
#include "core/decompose.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/options.h"
#include "core/records/provenance.h"
#include "core/records/request.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"

namespace isoline::benchmarks {

using networks::LayerFactor;
using networks::LayerMoments;
using problems::Point;
namespace {

constexpr double kRoundSeconds = 2e-4;  // of calls, so that a round is many of the short ones
constexpr double kOracleSeconds = 1e-2, kLongOracleSeconds = 0.15, kMatrixSeconds = 1e-2;
constexpr double kProblemSeconds = 1;
constexpr double kClockSeconds = 2e-5;  // a call this long can afford the clock of the processor
constexpr std::size_t kMostPairs = 1000, kMostRounds = 31, kFewRounds = 3;
constexpr Real kWidest = 4;  // a range over this factor, or down to nothing, says too little
constexpr Real kTail = 0.1;  // on either side of the middle 80 %

// Buffers for the inputs and outputs of a problem's oracles.
struct Room {
  explicit Room(const Problem& problem)
      : w(Matrix::Ones(problem.outputs(), problem.samples())),
        u(Matrix::Ones(problem.inputs(), problem.samples())),
        v(Vector::Ones(problem.unknowns())),
        y(w),
        x(u),
        gradient(v) {}

  Matrix w, u;  // (m, B), (k, B)
  Vector v;     // (n)
  Matrix y, x;  // (m, B), (k, B)
  Vector gradient;
  Matrix J, H, dy_dx, bent;
  std::vector<LayerFactor> factors;
  std::vector<LayerMoments> moments;
};

void ask(Oracle oracle, const Problem& problem, Point& at, Room& room) {
  switch (oracle) {
    case Oracle::pullback:
      return problem.pullback(room.w, room.gradient, at);
    case Oracle::pushforward:
      return problem.pushforward(room.v, room.y, at);
    case Oracle::jacobian:
      return problem.jacobian(room.J, at);
    case Oracle::hessian:
      return problem.hessian(room.H, at);
    case Oracle::curvature:
      room.bent.resize(problem.inputs(), problem.inputs() * problem.samples());
      return problem.curvature(room.w, room.bent, at);
    case Oracle::sensitivity:
      return problem.sensitivity(room.dy_dx, at);
    case Oracle::hessian_product:
      return problem.hessian_product(room.v, room.gradient, at);
    case Oracle::inverse:
      problem.local_inverse(problem.target(), room.x, at);
      return;
    case Oracle::network:
      return problem.network_pullback(room.u, room.gradient, at);
    case Oracle::layer_factors:
      return problem.layer_factors(room.w, room.factors, at);
    case Oracle::layer_moments:
      return problem.layer_moments(room.w, room.moments, room.gradient, at);
    case Oracle::forward:
    case Oracle::truth:  // nothing is computed
      return;
  }
}

// All that the problem offers and that is computed: products before the dense matrices, which
// large networks take up the time with.
std::vector<Oracle> measured_ones(OracleSet offered) {
  std::vector<Oracle> products, matrices;
  for (const OracleRow& row : kOracleTable) {
    const bool is_computed = row.kind != Oracle::forward && row.kind != Oracle::truth;
    if (!is_computed || !offered.contains(row.kind)) continue;
    (row.is_dense_matrix ? matrices : products).push_back(row.kind);
  }
  products.insert(products.end(), matrices.begin(), matrices.end());
  return products;
}

// Processor time; wall time if another process computes.
double seconds_by(bool is_elsewhere) {
  return is_elsewhere ? 1e-9 * static_cast<double>(monotonic_nanoseconds()) : processor_seconds();
}

// The time of one call: processor time if it is long enough to be interrupted, otherwise by its
// time-stamp counter, which costs little beside a microsecond.
double seconds_of(const Problem& problem, double expected, const std::function<void()>& call) {
  if (expected > kClockSeconds && !problem.is_elsewhere()) {
    const double begin = processor_seconds();
    call();
    return processor_seconds() - begin;
  }
  const std::uint64_t begin = ticks();
  call();
  return static_cast<double>(ticks() - begin) * seconds_per_tick();
}

Real at_share(std::vector<Real>& values, Real share) {
  const auto at = std::lround(share * static_cast<Real>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

// The expected times of one oracle and of the forward solve before it, in seconds.
struct Question {
  Oracle oracle;
  double forward, expected;
};

struct Rounds {
  std::vector<Real> forward_seconds, ratios;
  std::size_t calls = 0;
};

// On work space of its own: where arrays happen to lie is part of the range over rounds.
void add_round(const Problem& problem, const Question& of, Rounds& rounds) {
  Point at;
  Room room(problem);
  const double wanted = kRoundSeconds / std::max(of.forward, of.expected);
  const auto pairs = std::clamp(static_cast<std::size_t>(wanted), std::size_t{1}, kMostPairs);
  std::vector<Real> before, asked;
  for (std::size_t i = 0; i <= pairs; ++i) {
    const double solve =
        seconds_of(problem, of.forward, [&] { problem.forward(problem.start(), at); });
    const double call =
        seconds_of(problem, of.expected, [&] { ask(of.oracle, problem, at, room); });
    if (i == 0) continue;  // the first allocates
    before.push_back(solve);
    asked.push_back(call);
  }
  const Real forward = std::max(at_share(before, 0.5), 1e-9);
  rounds.calls += pairs;
  rounds.forward_seconds.push_back(forward);
  rounds.ratios.push_back(of.oracle == Oracle::forward ? 1 : at_share(asked, 0.5) / forward);
}

Rounds rounds_of(const Problem& problem, const Question& of) {
  Rounds rounds;
  const double begin = seconds_by(problem.is_elsewhere());
  while (rounds.ratios.size() < kMostRounds) {
    add_round(problem, of, rounds);
    const double spent = seconds_by(problem.is_elsewhere()) - begin;
    if (spent > kLongOracleSeconds) break;
    if (spent > kOracleSeconds && rounds.ratios.size() >= kFewRounds) break;
  }
  return rounds;
}

MeasuredPrice price_of(std::string_view name, std::int64_t declared, double forward,
                       Rounds& rounds) {
  MeasuredPrice price{.oracle = std::string(name),
                      .declared = declared,
                      .price = at_share(rounds.ratios, 0.5),
                      .low = at_share(rounds.ratios, kTail),
                      .high = at_share(rounds.ratios, 1 - kTail),
                      .rounds = static_cast<std::int64_t>(rounds.ratios.size()),
                      .calls = static_cast<std::int64_t>(rounds.calls)};
  price.resolved = is_resolved(price, forward);
  return price;
}

// The network alone, as `isoline infer` applies it, to the samples of a batch at once: what one of
// them takes. No forward solve goes before it, since none is needed.
MeasuredPrice inference_price(const Problem& problem, double forward) {
  const problems::Network& network = problem.network();
  const Matrix& input = problem.batch().input;
  const Vector& theta = problem.start();
  Rounds rounds;
  const double begin = processor_seconds();
  while (rounds.ratios.size() < kMostRounds) {
    Workspace workspace;
    Matrix x(problem.inputs(), problem.samples());
    const Vector statistics = network.statistics(theta, input, workspace);
    const auto infer = [&] { network.infer(theta, statistics, input, x, workspace); };
    seconds_of(problem, 1, infer);  // allocates
    const double once = seconds_of(problem, 1, infer);
    const auto calls = static_cast<std::size_t>(
        std::clamp(kRoundSeconds / std::max(once, 1e-9), 1.0, static_cast<double>(kMostPairs)));
    std::vector<Real> seconds;
    for (std::size_t i = 0; i < calls; ++i) seconds.push_back(seconds_of(problem, once, infer));
    rounds.calls += calls;
    rounds.ratios.push_back(std::max(at_share(seconds, 0.5), 1e-9) / forward /
                            static_cast<Real>(problem.samples()));
    if (processor_seconds() - begin > kLongOracleSeconds && rounds.ratios.size() >= kFewRounds)
      break;
  }
  return price_of(kInference, 0, forward, rounds);
}

}  // namespace

bool is_resolved(const MeasuredPrice& price, double forward_seconds) {
  return forward_seconds >= kLeastForwardSeconds && price.low > 0 &&
         price.high <= kWidest * price.low;
}

MeasuredPrices measure_prices(const Problem& problem, const std::string& build) {
  MeasuredPrices measured{.build = build, .processor = this_build()->processor, .oracles = {}};
  Point at;
  const std::function<void()> solve = [&] { problem.forward(problem.start(), at); };
  const double begin = seconds_by(problem.is_elsewhere());
  seconds_of(problem, 1, solve);  // allocates
  const double once = std::max(seconds_of(problem, 1, solve), 1e-9);
  Rounds alone = rounds_of(problem, {Oracle::forward, once, once});
  measured.forward_seconds = at_share(alone.forward_seconds, 0.5);
  const OracleCounts declared = problem.prices();
  const double forward = measured.forward_seconds;
  measured.oracles.push_back(price_of(name_of(Oracle::forward), 1, forward, alone));
  if (problem.is_learned()) measured.oracles.push_back(inference_price(problem, forward));
  for (const Oracle oracle : measured_ones(problem.offers())) {
    if (seconds_by(problem.is_elsewhere()) - begin > kProblemSeconds) break;
    const auto kind = static_cast<std::size_t>(oracle);
    const double expected = forward * static_cast<double>(declared[kind]);
    if (oracle_row(oracle).is_dense_matrix && expected > kMatrixSeconds) continue;
    Rounds rounds = rounds_of(problem, {oracle, forward, expected});
    measured.oracles.push_back(price_of(name_of(oracle), declared[kind], forward, rounds));
  }
  return measured;
}

std::string prices_build(const Component& problem) {
  return build_digest({.problem = problem, .optimizer = {}});
}

bool are_ours(const std::optional<MeasuredPrices>& prices, const std::string& build) {
  return prices && prices->build == build && prices->processor == this_build()->processor;
}

// Metadata of problems and optimizers, including plotted landscapes.

using optimizers::privileges_of;
namespace {

constexpr Index kGrid = 81;                       // points a side of a landscape
constexpr Index kSmall = 16;                      // largest target and truth in a file of metadata
constexpr Index kMostEntries = Index{256} * 256;  // of a Jacobian that is factorized: 20 ms
constexpr const char* kInverseNames[] = {"none", "exact", "damped", "estimate", "approximate"};

std::vector<std::string> names_of(OracleSet oracles) {
  std::vector<std::string> names;
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (oracles.contains(static_cast<Oracle>(kind))) names.emplace_back(kOracleNames[kind]);
  return names;
}

Real grid_point(Real low, Real high, Index i) {
  return low + (high - low) * static_cast<Real>(i) / static_cast<Real>(kGrid - 1);
}

std::vector<Real> small(const Matrix& values) {
  if (values.size() > kSmall) return {};
  return {values.data(), values.data() + values.size()};
}

bool has_small_jacobian(const Problem& problem) {
  const bool is_small = problem.unknowns() * problem.residuals() <= kMostEntries;
  return !problem.is_learned() && problem.has_identity_network() && is_small &&
         problem.offers().contains(Oracle::jacobian);
}

// σ_max / σ_min of J there; nothing if it is not a number.
std::optional<Real> condition_at(const Problem& problem, VectorRef theta) {
  Point at;
  Matrix J;
  Svd svd;
  problem.forward(theta, at);
  problem.jacobian(J, at);
  if (!J.allFinite() || !thin_svd(J, svd)) return std::nullopt;
  const Real least = J.rows() < J.cols() ? 0 : svd.sigma[svd.sigma.size() - 1];
  return least > 0 ? svd.sigma[0] / least : std::numeric_limits<Real>::infinity();
}

// x₁ and x₂, or y₁ and y₂, over a window.
template <class Visit>
void for_each_point(const std::array<Real, 4>& window, Visit visit) {
  const auto& [low1, high1, low2, high2] = window;
  for (Index j = 0; j < kGrid; ++j)
    for (Index i = 0; i < kGrid; ++i)
      visit(i, j, Eigen::Vector2d(grid_point(low1, high1, i), grid_point(low2, high2, j)));
}

// The least box around points, those aside that are not finite: one pole would make it boundless.
class Box {
 public:
  void include(const Eigen::Vector2d& point) {
    if (!point.allFinite()) return;
    low_ = low_.cwiseMin(point);
    high_ = high_.cwiseMax(point);
  }
  std::optional<std::array<Real, 4>> window() const {
    if (!low_.allFinite()) return std::nullopt;
    return std::array<Real, 4>{low_[0], high_[0], low_[1], high_[1]};
  }

 private:
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(std::numeric_limits<Real>::infinity());
  Eigen::Vector2d high_ = -low_;
};

// L over the problem's window in x, and over the box in y that the window maps into.
void draw_landscapes(const Problem& problem, Sheet& sheet) {
  Landscape in_x{*problem.window(), Grid(kGrid, kGrid), problem.contour_spacing()};
  Box image;
  Point point;
  for_each_point(in_x.window, [&](Index i, Index j, const Eigen::Vector2d& x) {
    problem.forward(x, point);
    in_x.loss(i, j) = point.loss;
    if (problem.outputs() == 2) image.include(point.y.col(0));
  });
  sheet.landscape_x = in_x;
  const auto window = problem.y_window() ? problem.y_window() : image.window();
  if (problem.outputs() != 2 || !window) return;
  Landscape in_y{*window, Grid(kGrid, kGrid), problem.contour_spacing()};
  for_each_point(in_y.window, [&](Index i, Index j, const Eigen::Vector2d& y) {
    in_y.loss(i, j) = problem.loss_of(y);
  });
  sheet.landscape_y = in_y;
}

// y = x with an inverse of every kind: the calls of a method show its extra information.
class Witness final : public problems::Physics {
 public:
  explicit Witness(Inverse kind) : kind_(kind) {}
  Index inputs() const override { return 1; }
  Index outputs() const override { return 1; }
  void forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const override { y = x; }
  void pushforward(BatchRef v, BatchOut Jv, Workspace&) const override { Jv = v; }
  void pullback(BatchRef u, BatchOut JTu, Workspace&) const override { JTu = u; }
  Inverse inverse_kind() const override { return kind_; }

 private:
  Inverse kind_;
};

std::vector<std::string> possible_privileges(const OptimizerEntry& entry,
                                             const Component& component) {
  std::vector<std::string> all;
  for (const Inverse kind :
       {Inverse::exact, Inverse::damped, Inverse::approximate, Inverse::estimate}) {
    const Problem problem({.physics = std::make_unique<Witness>(kind),
                           .start = Vector::Ones(1),
                           .target = Matrix::Zero(1, 1)});
    for (const std::string& one : privileges_of(needs_of(entry, component.options, problem), kind))
      if (std::ranges::find(all, one) == all.end()) all.push_back(one);
  }
  return all;
}

// Replaces the adapter's description by the external program's own.
void add_words_of(const Foreign& foreign, Sheet& sheet) {
  if (!foreign.label.empty()) sheet.title = foreign.label + ", by another program";
  if (!foreign.source.empty()) sheet.source = foreign.source;
  if (!foreign.note.empty()) sheet.note = foreign.note;
}

// The registry's view of a component, without creating one.
template <class Entry>
Sheet described(const char* kind, const Entry& entry, const Component& component) {
  Sheet sheet{.kind = kind,
              .name = entry.name,
              .spec = component.spec,
              .title = entry.title,
              .formula = entry.formula,
              .source = entry.source,
              .note = entry.note,
              .options_text = json_text(describe_options(entry.options))};
  if (component.foreign) add_words_of(*component.foreign, sheet);
  return sheet;
}

}  // namespace

Sheet described_problem(const Catalog& catalog, const Component& component) {
  const ProblemEntry& entry = catalog.problems.at(component.name);
  Sheet sheet = described("problem", entry, component);
  sheet.aim = entry.aim;
  sheet.group = std::string(name_of(entry.group));
  sheet.panels = entry.panels;
  return sheet;
}

Sheet described_optimizer(const Catalog& catalog, const Component& component) {
  const OptimizerEntry& entry = catalog.optimizers.at(component.name);
  Sheet sheet = described("optimizer", entry, component);
  sheet.oracles = names_of(entry.needs);
  sheet.family = std::string(name_of(entry.family));
  sheet.mathematics = std::string(name_of(entry.kind));
  sheet.tunable = entry.tunable.option;
  return sheet;
}

Sheet problem_sheet(const Catalog& catalog, const Component& component) {
  const Problem problem = make_problem(catalog, component, 0);
  Sheet sheet = described_problem(catalog, component);
  sheet.aim = problem.aim();  // as its entry has it, or as another program says
  sheet.oracles = names_of(problem.offers());
  sheet.inverse = kInverseNames[static_cast<int>(problem.inverse_kind())];
  sheet.unknowns = problem.unknowns();
  sheet.residuals = problem.residuals();
  sheet.target = small(problem.target());
  if (has_small_jacobian(problem)) {
    sheet.start_condition = condition_at(problem, problem.start());
    if (problem.truth()) sheet.condition = condition_at(problem, problem.truth()->reshaped());
  }
  sheet.field = problem.field();
  if (problem.truth()) sheet.truth = small(*problem.truth());
  if (problem.window() && problem.unknowns() == 2) draw_landscapes(problem, sheet);
  return sheet;
}

Sheet optimizer_sheet(const Catalog& catalog, const Component& component) {
  Sheet sheet = described_optimizer(catalog, component);
  sheet.privileges = possible_privileges(catalog.optimizers.at(component.name), component);
  return sheet;
}

// Writes the metadata of a plan's components, each in its own process, and measures the costs of
// its problems.

namespace {

constexpr double kSheetSeconds = 30;

// Creates metadata, each in its own process: a failure costs the measured values of one file.
class SheetWriter {
 public:
  SheetWriter(const Catalog& catalog, Store& store, Progress::Style style)
      : catalog_(catalog), store_(store), progress_(style, "sheets", 0, 0) {}

  void write_problem(const Component& component) {
    if (!known_.insert("problem " + component.spec).second) return;
    progress_.started(component.spec);
    Sheet sheet = described_problem(catalog_, component);
    if (replace(sheet, [&] { return problem_sheet(catalog_, component); }))
      sheet.prices = prices_of(component, sheet.file_name());
    write(sheet);
  }

  void write_optimizer(const Component& component) {
    if (!known_.insert("optimizer " + component.spec).second) return;
    Sheet sheet = described_optimizer(catalog_, component);
    replace(sheet, [&] { return optimizer_sheet(catalog_, component); });
    write(sheet);
  }

 private:
  // By the whole one, where that can be made.
  bool replace(Sheet& sheet, const std::function<Sheet()>& make) {
    const IsolatedText made = isolated([&] { return file_text(make()); });
    std::string reason = made.failure;
    if (made.text) try {
        sheet = sheet_from_text(*made.text, "its output");
        return true;
      } catch (const std::exception& error) {
        reason = error.what();
      }
    store_.remark(fmt::format("the metadata of {} contain only what the registry knows: {}",
                              sheet.spec, reason));
    return false;
  }

  void write(const Sheet& sheet) {
    try {
      store_.write(sheet);
    } catch (const std::exception& error) {
      store_.remark(fmt::format("the metadata of {} are missing: {}", sheet.spec, error.what()));
    }
  }

  std::optional<MeasuredPrices> stored_prices(const std::filesystem::path& file) {
    if (!is_there(file)) return std::nullopt;
    try {
      return sheet_from_text(read_text(file), file.string()).prices;
    } catch (const std::exception& error) {
      store_.set_aside(file, error.what());
      return std::nullopt;
    }
  }

  // Costs that this build has already measured on this processor: a continued run does not change
  // the report of finished cells. The problem is created again, and a failure of the measurement
  // does not cost the metadata.
  std::optional<MeasuredPrices> prices_of(const Component& component, const std::string& file) {
    const std::string build = prices_build(component);
    auto stored = stored_prices(store_.folder() / "components" / file);
    if (are_ours(stored, build)) return stored;
    const auto measured = [&] {
      Sheet sheet;
      sheet.options_text = "[]";
      sheet.prices = measure_prices(make_problem(catalog_, component, 0), build);
      return file_text(sheet);
    };
    const auto text = isolated(measured).text;
    if (text) try {
        return sheet_from_text(*text, "prices of " + component.spec).prices;
      } catch (const UsageError&) {  // declared ones are counted with
      }
    return std::nullopt;
  }

  IsolatedText isolated(const std::function<std::string()>& work) {
    return isolated_text(work, kSheetSeconds, Limits{}.memory_bytes, [&] { progress_.show(); });
  }

  const Catalog& catalog_;
  Store& store_;
  Progress progress_;
  std::set<std::string> known_;
};

}  // namespace

void write_sheets(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
                  Progress::Style style) {
  SheetWriter writer(catalog, store, style);
  for (const Request& request : requests) {
    if (asked_to_end() != Asked::nothing) return;
    writer.write_problem(request.problem);
    writer.write_optimizer(request.optimizer);
  }
}

}  // namespace isoline::benchmarks
