// Writes component metadata, and measures the costs in them. One measurement is a forward solve at
// a new point and one call of the oracle after it, timed separately; a round is many such pairs on
// its own work space. The cost is the ratio of the two medians, without any subtraction. Drift and
// other load of the machine therefore hardly affect it. The call includes everything that it has to
// prepare at a new point.
#include "benchmarks/run/sheets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/calls.h"
#include "benchmarks/run/isolate.h"
#include "core/clock.h"
#include "core/decompose.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/foreign/evaluations.h"
#include "core/json.h"
#include "core/options.h"
#include "core/records/json_view.h"
#include "core/records/provenance.h"
#include "core/records/request.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"

namespace isoline::benchmarks {

std::string build_of(const Component& problem) {
  return build_digest({.problem = problem, .optimizer = {}});
}

namespace {

constexpr double kRoundSeconds = 2e-4;  // so that a round is many calls of the short ones
constexpr double kOracleSeconds = 4e-3, kLongOracleSeconds = 0.15, kProblemSeconds = 1;
constexpr double kLongestMatrixSeconds = 1e-2;  // of a dense matrix that is measured
constexpr double kClockSeconds = 2e-5;  // a call this long can afford the clock of the processor
constexpr std::size_t kMostPairs = 1000, kMostRounds = 31, kFewRounds = 3;
constexpr std::size_t kRoundsElsewhere = 2, kMostCallsElsewhere = 20;  // of another program
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
  Vector sparse;
  std::vector<networks::LayerFactor> factors;
  std::vector<networks::LayerMoments> moments;
  Workspace space;
};

// The calls of all oracles that compute something beside the forward solve.
const std::map<Oracle, std::function<void(const Problem&, Point&, Room&)>> kCalls = {
    {Oracle::pullback, [](auto& p, auto& at, auto& r) { p.pullback(r.w, r.gradient, at); }},
    {Oracle::pushforward, [](auto& p, auto& at, auto& r) { p.pushforward(r.v, r.y, at); }},
    {Oracle::jacobian, [](auto& p, auto& at, auto& r) { p.jacobian(r.J, at); }},
    {Oracle::sparse_jacobian, [](auto& p, auto& at, auto& r) { p.sparse_jacobian(r.sparse, at); }},
    {Oracle::hessian, [](auto& p, auto& at, auto& r) { p.hessian(r.H, at); }},
    {Oracle::curvature,
     [](auto& p, auto& at, auto& r) {
       r.bent.resize(p.inputs(), p.inputs() * p.samples());
       p.curvature(r.w, r.bent, at);
     }},
    {Oracle::sensitivity, [](auto& p, auto& at, auto& r) { p.sensitivity(r.dy_dx, at); }},
    {Oracle::hessian_product,
     [](auto& p, auto& at, auto& r) { p.hessian_product(r.v, r.gradient, at); }},
    {Oracle::inverse, [](auto& p, auto& at, auto& r) { p.local_inverse(p.target(), r.x, at); }},
    {Oracle::network, [](auto& p, auto& at, auto& r) { p.network_pullback(r.u, r.gradient, at); }},
    {Oracle::layer_factors,
     [](auto& p, auto& at, auto& r) { p.layer_factors(r.w, r.factors, at); }},
    {Oracle::layer_moments,
     [](auto& p, auto& at, auto& r) { p.layer_moments(r.w, r.moments, r.gradient, at); }}};

// Processor time; wall time if another process computes.
double seconds_by(bool is_elsewhere) {
  return is_elsewhere ? 1e-9 * static_cast<double>(monotonic_nanoseconds()) : processor_seconds();
}

// The time of one call: processor time if it is long enough to be interrupted, otherwise by its
// time-stamp counter, which costs little beside a microsecond. Of another program, as it was when
// the call was made.
double seconds_of(const Problem& problem, double expected, const std::function<void()>& call) {
  if (problem.is_elsewhere()) {
    const double begin = call_clock();
    call();
    return call_clock() - begin;
  }
  if (expected > kClockSeconds) {
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

// A call at a point, none for the forward solve alone, and the expected times of the two.
struct Question {
  double forward, expected;  // seconds
  std::function<void(Point&, Room&)> call = {};
};

struct Rounds {
  std::vector<Real> forward_seconds, ratios;
  std::size_t calls = 0;
};

// On work space of its own: where arrays happen to lie is part of the range over rounds.
void add_round(const Problem& problem, const Question& of, Rounds& rounds) {
  Point at;
  Room room(problem);
  std::vector<Real> before, asked;
  double spent = 0;
  const bool is_elsewhere = problem.is_elsewhere();  // there, a pair is a round
  for (std::size_t i = is_elsewhere ? 1 : 0;
       i <= (is_elsewhere ? 1 : kMostPairs) && (i < 2 || spent < kRoundSeconds); ++i) {
    const double solve =
        seconds_of(problem, of.forward, [&] { problem.forward(problem.start(), at); });
    const double call =
        of.call ? seconds_of(problem, of.expected, [&] { of.call(at, room); }) : solve;
    if (i == 0) continue;  // the first allocates
    spent += solve + call;
    before.push_back(solve);
    asked.push_back(call);
  }
  const Real forward = std::max(at_share(before, 0.5), 1e-9);
  rounds.calls += before.size();
  rounds.forward_seconds.push_back(forward);
  rounds.ratios.push_back(of.call ? at_share(asked, 0.5) / forward : 1);
}

Rounds rounds_of(const Problem& problem, const Question& of) {
  Rounds rounds;
  const double begin = seconds_by(problem.is_elsewhere());
  while (rounds.ratios.size() < (problem.is_elsewhere() ? kRoundsElsewhere : kMostRounds)) {
    add_round(problem, of, rounds);
    const double spent = seconds_by(problem.is_elsewhere()) - begin;
    if (spent > kLongOracleSeconds) break;
    if (spent > kOracleSeconds && rounds.ratios.size() >= kFewRounds) break;
  }
  return rounds;
}

MeasuredPrice price_of(std::string_view name, std::int64_t declared, double forward,
                       Rounds rounds) {
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

// The network alone, as `isoline solution` applies it, to the samples of a batch at once: what one
// of them takes.
MeasuredPrice inference_price(const Problem& problem, double forward, Real unit) {
  const problems::Network& network = problem.network();
  const Matrix& input = problem.batch().input;
  Workspace workspace;
  const Vector statistics = network.statistics(problem.start(), input, workspace);
  const auto infer = [&](Point&, Room& room) {
    network.infer(problem.start(), statistics, input, room.x, room.space);
  };
  Rounds rounds = rounds_of(problem, {forward, forward, infer});
  for (Real& ratio : rounds.ratios) ratio *= unit / static_cast<Real>(problem.samples());
  return price_of(kInference, 0, forward, std::move(rounds));
}

// --- metadata of problems and optimizers, including plotted landscapes

constexpr Index kGrid = 81;  // points a side of a landscape

std::vector<std::string> names_of(OracleSet oracles) {
  std::vector<std::string> names;
  for (const OracleRow& row : kOracleTable)
    if (oracles.contains(row.kind)) names.emplace_back(row.name);
  return names;
}

std::vector<Real> small(const Matrix& values) {
  constexpr Index kSmall = 16;  // largest target and truth in a file of metadata
  if (values.size() > kSmall) return {};
  return {values.data(), values.data() + values.size()};
}

// σ_max / σ_min of J there; nothing if it is not a number, or of a slow program.
std::optional<Real> condition_at(const Problem& problem, VectorRef theta) {
  Point at;
  Matrix J;
  Svd svd;
  const double begin = call_clock();
  problem.forward(theta, at);
  if (problem.is_elsewhere() && call_clock() - begin >= kSlowSeconds) return std::nullopt;
  problem.jacobian(J, at);
  if (!J.allFinite() || !thin_svd(J, svd)) return std::nullopt;
  const Real least = J.rows() < J.cols() ? 0 : svd.sigma[svd.sigma.size() - 1];
  return least > 0 ? svd.sigma[0] / least : std::numeric_limits<Real>::infinity();
}

// x₁ and x₂, or y₁ and y₂, over a window.
template <class Visit>
void for_each_point(const std::array<Real, 4>& window, Visit visit) {
  const auto& [low1, high1, low2, high2] = window;
  const auto point = [](Real low, Real high, Index i) {
    return low + (high - low) * static_cast<Real>(i) / static_cast<Real>(kGrid - 1);
  };
  for (Index j = 0; j < kGrid; ++j)
    for (Index i = 0; i < kGrid; ++i)
      visit(i, j, Eigen::Vector2d(point(low1, high1, i), point(low2, high2, j)));
}

// L over the problem's window in x, and over the box in y that the window maps into.
void draw_landscapes(const Problem& problem, Sheet& sheet) {
  Landscape in_x{*problem.window(), Grid(kGrid, kGrid), problem.contour_spacing()};
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<Real>::infinity());
  Eigen::Vector2d high = -low;  // y that are not finite aside: one pole would make it boundless
  Point point;
  for_each_point(in_x.window, [&](Index i, Index j, const Eigen::Vector2d& x) {
    problem.forward(x, point);
    in_x.loss(i, j) = point.loss;
    if (problem.outputs() != 2 || !point.y.allFinite()) return;
    low = low.cwiseMin(point.y.col(0));
    high = high.cwiseMax(point.y.col(0));
  });
  sheet.landscape_x = in_x;
  auto window = problem.y_window();
  if (!window && low.allFinite()) window = {low[0], high[0], low[1], high[1]};
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
    const OracleSet needs = needs_of(entry, component.options, problem);
    for (const std::string& one : optimizers::privileges_of(needs, kind))
      if (std::ranges::find(all, one) == all.end()) all.push_back(one);
  }
  return all;
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
              .note = entry.note};
  OptionTable options = entry.options;
  if (component.foreign)
    options.insert(options.end(), component.foreign->options.begin(),
                   component.foreign->options.end());
  sheet.options_text = json_text(describe_options(options));
  if (const auto& foreign = component.foreign) {  // its words replace those of the adapter
    if (!foreign->label.empty()) sheet.title = foreign->label + ", by another program";
    if (!foreign->source.empty()) sheet.source = foreign->source;
    if (!foreign->note.empty()) sheet.note = foreign->note;
  }
  return sheet;
}

// --- the metadata of a plan

// Creates metadata, each in its own process: a failure costs the measured values of one file.
class SheetWriter {
 public:
  SheetWriter(const Catalog& catalog, Store& store, Progress::Style style,
              const Certificates& certificates)
      : catalog_(catalog),
        store_(store),
        progress_(style, "measures costs of", 0, 0),
        certificates_(certificates) {}

  void write_problem(const Request& request) {
    const Component& component = request.problem;
    request_ = &request;
    if (!known_.insert("problem " + component.spec).second) return;
    progress_.started(component.spec);
    Sheet sheet = described_problem(catalog_, component);
    std::optional<Sheet> stored = stored_sheet(component, sheet);
    if (stored && is_elsewhere(component))
      sheet = std::move(*stored);  // without a call
    else if (replace(sheet, component, [&] { return whole_sheet(component); }) && !sheet.prices)
      sheet.prices = stored ? stored->prices : measured_prices(component);
    const auto passed = certificates_.find(component.spec);
    if (passed != certificates_.end()) sheet.certified = passed->second;
    write(sheet);
  }

  void write_optimizer(const Component& component) {
    if (!known_.insert("optimizer " + component.spec).second) return;
    Sheet sheet = described_optimizer(catalog_, component);
    replace(sheet, component, [&] { return optimizer_sheet(catalog_, component); });
    write(sheet);
  }

 private:
  // With the costs of another program, which would count its calls for making the problem twice.
  Sheet whole_sheet(const Component& component) {
    const Problem problem = make_problem(catalog_, component, 0);
    Sheet sheet = problem_sheet(catalog_, component, problem);
    if (problem.is_elsewhere()) sheet.prices = measure_prices(problem, build_of(component));
    return sheet;
  }

  // By the whole one, where that can be made.
  bool replace(Sheet& sheet, const Component& component, const std::function<Sheet()>& make) {
    std::string reason;
    if (auto made = made_apart(component, make, reason)) {
      sheet = std::move(*made);
      return true;
    }
    store_.remark(fmt::format("the metadata of {} are incomplete: {}", sheet.spec, reason));
    return false;
  }

  void write(const Sheet& sheet) {
    try {
      store_.write(sheet);
    } catch (const std::exception& error) {
      store_.remark(fmt::format("the metadata of {} are missing: {}", sheet.spec, error.what()));
    }
  }

  // That with costs which this build has already measured on this processor: a continued run does
  // not change the report of finished cells.
  std::optional<Sheet> stored_sheet(const Component& component, const Sheet& described) {
    const auto file = store_.folder() / "components" / described.file_name();
    if (is_there(file)) try {
        Sheet stored = sheet_from_text(read_text(file), file.string());
        if (stored.prices && stored.prices->build == build_of(component) &&
            stored.prices->processor == this_build()->processor)
          return stored;
      } catch (const std::exception& error) {
        store_.set_aside(file, reason_of(error));
      }
    return std::nullopt;
  }

  // The problem is created again, and a failure of the measurement does not cost the metadata: then
  // declared costs are counted with.
  std::optional<MeasuredPrices> measured_prices(const Component& component) {
    std::string reason;
    const auto measured = made_apart(
        component,
        [&] {
          Sheet sheet;
          sheet.options_text = "[]";
          sheet.prices = measure_prices(make_problem(catalog_, component, 0), build_of(component));
          return sheet;
        },
        reason);
    return measured ? measured->prices : std::nullopt;
  }

  // The calls of its checks are not made again.
  std::optional<Sheet> made_apart(const Component& component, const std::function<Sheet()>& make,
                                  std::string& reason) {
    constexpr double kSeconds = 30;
    const auto work = [&] {
      if (is_elsewhere(component)) {
        evaluations().begin({.folder = store_.folder()});
        limit_calls(*request_);
      }
      return file_text(make());
    };
    const IsolatedText made = isolated_text(work, text_seconds_of(component, kSeconds),
                                            Limits{}.memory_bytes, [&] { progress_.show(); });
    reason = made.failure;
    if (made.text) try {
        return sheet_from_text(*made.text, "its output");
      } catch (const std::exception& error) {
        reason = error.what();
      }
    return std::nullopt;
  }

  const Catalog& catalog_;
  Store& store_;
  Progress progress_;
  const Certificates& certificates_;
  const Request* request_ = nullptr;  // whose problem or optimizer is written
  std::set<std::string> known_;
};

}  // namespace

bool is_resolved(const MeasuredPrice& price, double forward_seconds) {
  constexpr double kLeastForwardSeconds = 1e-6;
  constexpr Real kWidest = 4;  // a range over this factor, or down to nothing, says too little
  return forward_seconds >= kLeastForwardSeconds && price.low > 0 &&
         price.high <= kWidest * price.low;
}

MeasuredPrices measure_prices(const Problem& problem, const std::string& build) {
  MeasuredPrices measured{.build = build, .processor = this_build()->processor, .oracles = {}};
  Point at;
  const std::function<void()> solve = [&] { problem.forward(problem.start(), at); };
  const double begin = seconds_by(problem.is_elsewhere());
  const double first = seconds_of(problem, 1, solve);  // allocates
  if (problem.is_elsewhere() && first >= kSlowSeconds) {
    measured.forward_seconds = first;
    measured.oracles.push_back(price_of(name_of(Oracle::forward), 1, first, {{first}, {1}, 1}));
    return measured;
  }
  if (problem.is_elsewhere()) evaluations().begin({});
  const Afresh afresh;  // the others are made, and timed
  const double once = std::max(seconds_of(problem, 1, solve), 1e-9);
  Rounds alone = rounds_of(problem, {once, once});
  const double forward = at_share(alone.forward_seconds, 0.5);
  // As many calls as a solve counts, by iterations; a call of another oracle is still one.
  const auto unit = static_cast<Real>(problem.solve_iterations(problem.batch()));
  measured.forward_seconds = forward / unit;
  measured.oracles.push_back(price_of(name_of(Oracle::forward), 1, forward, std::move(alone)));
  if (problem.is_learned()) measured.oracles.push_back(inference_price(problem, forward, unit));
  std::size_t calls = 2 + kRoundsElsewhere;
  // Products before the dense matrices, which large networks take up the time with.
  for (const bool is_matrix : {false, true})
    for (const OracleRow& row : kOracleTable) {
      const auto found = kCalls.find(row.kind);
      if (found == kCalls.end() || row.is_dense_matrix != is_matrix ||
          !problem.offers().contains(row.kind))
        continue;
      if (problem.is_elsewhere()) {
        if (problem.products().are_differences && row.kind != Oracle::inverse) continue;
        calls += 2 * kRoundsElsewhere;
        if (calls > kMostCallsElsewhere) return measured;
      }
      if (seconds_by(problem.is_elsewhere()) - begin > kProblemSeconds) return measured;
      const std::int64_t declared = problem.prices()[static_cast<std::size_t>(row.kind)];
      const double expected = forward * static_cast<double>(declared);
      if (is_matrix && expected > kLongestMatrixSeconds) continue;
      const auto call = [&](Point& there, Room& room) { found->second(problem, there, room); };
      Rounds rounds = rounds_of(problem, {forward, expected, call});
      if (!Problem::is_solve(row.kind))
        for (Real& ratio : rounds.ratios) ratio *= unit;
      measured.oracles.push_back(price_of(row.name, declared, forward, std::move(rounds)));
    }
  return measured;
}

Sheet described_problem(const Catalog& catalog, const Component& component) {
  const ProblemEntry& entry = catalog.problems.at(component.name);
  Sheet sheet = described("problem", entry, component);
  sheet.aim = entry.aim;
  sheet.group = std::string(name_of(entry.group));
  sheet.family = component.foreign ? entry.name : family_of(entry);
  sheet.linear = entry.is_linear && !component.is_learned;
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
  return problem_sheet(catalog, component, make_problem(catalog, component, 0));
}

Sheet problem_sheet(const Catalog& catalog, const Component& component, const Problem& problem) {
  constexpr const char* kInverses[] = {"none", "exact", "damped", "estimate", "approximate"};
  Sheet sheet = described_problem(catalog, component);
  sheet.aim = problem.aim();  // as its entry has it, or as another program says
  sheet.oracles = names_of(problem.offers());
  sheet.inverse = kInverses[static_cast<int>(problem.inverse_kind())];
  sheet.unknowns = problem.unknowns();
  sheet.residuals = problem.residuals();
  sheet.target = small(problem.target());
  constexpr Index kMostEntries = Index{256} * 256;  // of a J that is factorized: 20 ms
  if (!problem.is_learned() && problem.has_identity_network() &&
      problem.offers().contains(Oracle::jacobian) &&
      problem.unknowns() * problem.residuals() <= kMostEntries) {
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

void write_sheets(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
                  Progress::Style style, const Certificates& certificates) {
  SheetWriter writer(catalog, store, style, certificates);
  for (const Request& request : requests) {
    if (asked_to_end() != Asked::nothing) return;
    writer.write_problem(request);
    writer.write_optimizer(request.optimizer);
  }
}

}  // namespace isoline::benchmarks
