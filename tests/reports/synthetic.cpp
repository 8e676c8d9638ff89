// Invented runs: losses that fall by the power of a method and the difficulty of a problem, drawn
// by named streams, so that every record is the same wherever and in whatever order it is made.
#include "tests/reports/synthetic.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/json.h"
#include "core/random.h"
#include "core/records/request.h"
#include "core/records/sheet.h"
#include "core/status.h"

namespace isoline::reports {
namespace {

constexpr std::array kPhysics = {"poisson", "heat",  "wave",    "lens",  "chain",
                                 "burgers", "fluid", "elastic", "radar", "tomography"};
constexpr std::array kMethods = {"gd",     "momentum", "adam", "lbfgs", "gauss-newton",
                                 "hybrid", "newton",   "sip",  "hig",   "simplex"};
constexpr std::size_t kPrivileged = 6, kLimited = 9;  // methods: told the Hessian; of few unknowns
constexpr Real kStart = 3.7, kTarget = 1e-10;

struct Place {
  std::size_t problem, optimizer, seed;
};

Place place_of(const SyntheticSize& size, std::size_t index) {
  const std::size_t pair = index / size.seeds;
  return {pair / size.optimizers, pair % size.optimizers, index % size.seeds};
}

Component component(const char* name, const char* option, std::size_t value) {
  return {.name = name,
          .options = {{option, static_cast<Index>(value)},
                      {"mode", "direct"},
                      {"network", "mlp[layers=32-64-32]"}},
          .spec = fmt::format("{}[{}={}]", name, option, value)};
}

Component problem_at(std::size_t p) {
  return component(kPhysics[p % kPhysics.size()], "n", 16 + 8 * (p / kPhysics.size()));
}
Component optimizer_at(std::size_t s) {
  return component(kMethods[s % kMethods.size()], "memory", 4 + s / kMethods.size());
}

bool is_declared(std::size_t problem) { return problem % 5 != 4; }
bool is_inapplicable(const Place& at) {
  return at.optimizer % kMethods.size() == kLimited && at.problem % 3 == 0;
}

Request request_of(const SyntheticSize& size, const Place& at) {
  return {.problem = problem_at(at.problem),
          .optimizer = optimizer_at(at.optimizer),
          .seed = size.random_seed + at.seed,
          .budget = {.iterations = 100'000, .work = 20'000, .target = kTarget}};
}

// Iterations 0, 1, 2, … and then ever wider apart, as the kept points of a run are.
std::int64_t iteration_at(std::size_t point) {
  constexpr std::size_t kDense = 40;
  constexpr Real kWider = 1.15;
  if (point < kDense) return static_cast<std::int64_t>(point);
  return std::llround(kDense * std::pow(kWider, static_cast<Real>(point - kDense)));
}

constexpr OracleCounts kPrices = {1, 1, 1, 4, 4, 4, 4, 2, 1, 0, 1, 0};

std::int64_t priced(const Curve& curve) {
  std::int64_t work = 0;
  for (const auto& [name, column] : curve.counts)
    work += column.back() *
            kPrices[std::size_t(std::ranges::find(kOracleNames, name) - kOracleNames.begin())];
  return work;
}

void add_point(Record& record, std::int64_t iteration, Real loss, RandomStream& random) {
  Curve& curve = record.curve;
  const std::int64_t forwards = 1 + 2 * iteration;
  const Real seconds = 2.3e-6 * static_cast<Real>(forwards) * random.uniform(0.9, 1.1);
  const bool is_first = curve.iteration.empty();
  curve.iteration.push_back(iteration);
  curve.counts["forward"].push_back(forwards);
  curve.counts["pullback"].push_back(iteration);
  curve.counts["jacobian"].push_back(iteration / 2);
  curve.counts["inverse"].push_back(iteration / 4);
  curve.work.push_back(priced(curve));
  curve.wall_seconds.push_back(is_first ? 0 : std::max(seconds, curve.wall_seconds.back()));
  curve.processor_seconds.push_back(0.98 * curve.wall_seconds.back());
  curve.loss.push_back(loss);
  curve.x_error.push_back(0.9 * std::pow(loss, 0.4) * random.uniform(0.8, 1.2));
  curve.gradient_norm.push_back(std::sqrt(loss) * random.uniform(1, 2));
  curve.step_norm.push_back(is_first ? 0 : std::sqrt(loss) * random.uniform(0.01, 0.02));
}

// Decades of loss by iteration: power of the method, difficulty of the problem, luck of the pair.
void fill_curve(Record& record, const SyntheticSize& size, const Place& at) {
  RandomStream pair(size.random_seed, record.request.problem.spec, record.request.optimizer.spec);
  RandomStream random(size.random_seed, record.request.problem.spec, record.request.optimizer.spec,
                      1 + at.seed);
  const auto power = static_cast<Real>(at.optimizer % kMethods.size());
  const Real speed = 0.002 * std::pow(2.0, power) * std::exp(2 * pair.uniform(-1, 1));
  const Real floor = std::pow(10.0, pair.uniform(-16, -3));
  const Real luck = random.uniform(0.8, 1.25);
  for (std::size_t k = 0; k < size.points; ++k) {
    const std::int64_t iteration = iteration_at(k);
    const Real fallen = std::pow(10.0, -speed * luck * static_cast<Real>(iteration));
    const Real wiggle = k == 0 ? 1 : random.uniform(0.7, 1);
    add_point(record, iteration, kStart * (fallen * wiggle + (k == 0 ? 0 : floor)), random);
  }
}

// Read off the curve: of invented runs the kept points are all there is.
Hits hits_of(const Curve& curve) {
  Hits hits;
  std::size_t k = 0;
  for (int j = 0; j <= 50; ++j) {
    const Real tau = rung(static_cast<std::size_t>(j));
    while (k < curve.loss.size() && curve.loss[k] > tau * curve.loss[0]) ++k;
    const bool is_met = k < curve.loss.size();
    hits.target.push_back(tau);
    hits.iteration.push_back(is_met ? curve.iteration[k] : -1);
    hits.work.push_back(is_met ? curve.work[k] : 0);
    hits.forwards.push_back(is_met ? curve.counts.at("forward")[k] : 0);
    hits.wall_seconds.push_back(is_met ? curve.wall_seconds[k] : NAN);
  }
  return hits;
}

void summarize(Record& record) {
  const Curve& curve = record.curve;
  for (const auto& [name, column] : curve.counts)
    record.counts[std::size_t(std::ranges::find(kOracleNames, name) - kOracleNames.begin())] =
        column.back();
  record.prices = kPrices;
  const Real best = std::ranges::min(curve.loss);
  record.status = best <= kTarget * kStart ? Status::target : Status::budget;
  record.summary = {.iterations = curve.iteration.back(),
                    .work = curve.work.back(),
                    .start_loss = curve.loss.front(),
                    .loss = curve.loss.back(),
                    .best_loss = best,
                    .start_x_error = curve.x_error.front(),
                    .x_error = curve.x_error.back(),
                    .gradient_norm = curve.gradient_norm.back(),
                    .wall_seconds = curve.wall_seconds.back(),
                    .processor_seconds = curve.processor_seconds.back(),
                    .peak_memory_bytes = 16'834'560};
  record.repeat_wall_seconds = {record.summary.wall_seconds};
  for (const auto& [name, tau] : kVerified)
    if (record.minimum) record.verified[name] = best <= tau * kStart;
}

// One in a hundred; a method's fault, a machine's, or a limit's.
void fail_some(Record& record, const SyntheticSize& size, std::size_t index) {
  constexpr std::array<std::pair<Status, const char*>, 4> kFates = {
      {{Status::crashed, "signal 11 (Segmentation fault)"},
       {Status::failed, "std::bad_alloc"},
       {Status::timeout, "killed at its hard limit of 60 s"},
       {Status::diverged, "the loss is not finite at iteration 17"}}};
  RandomStream random(size.random_seed, "synthetic", "fate", index);
  if (random.uniform() >= 0.01) return;
  std::tie(record.status, record.message) =
      kFates[static_cast<std::size_t>(random.uniform(0, Real(kFates.size())))];
  record.is_nondeterministic = record.status == Status::timeout;
}

Provenance provenance_of(std::size_t index) {
  static const auto build = std::make_shared<const Build>(
      Build{.version = "0.1.0",
            .commit = "50abae804b9a",
            .is_dirty = false,
            .compiler = "g++ 12.2.0",
            .build_type = "Release",
            .flags = "-O3 -DNDEBUG -march=native",
            .instruction_set = "native avx2 fma avx512f",
            .processor = "Intel(R) Xeon(R) Processor @ 2.70GHz",
            .cores = 16,
            .system = "Debian GNU/Linux 12 (bookworm), Linux 6.1.0-28-amd64",
            .libraries = {{"Ceres", "2.1.0"}, {"OpenBLAS", "0.3.21 Cooperlake"}}});
  return {build,
          {.started = fmt::format("2026-01-{:02}T{:02}:{:02}:{:02}Z", 1 + index / 86400 % 28,
                                  index / 3600 % 24, index / 60 % 60, index % 60),
           .concurrent_jobs = 16,
           .is_exclusive = false,
           .command = "isoline run synthetic --jobs 16 --shard 3/8 --out results/synthetic"}};
}

}  // namespace

Record synthetic_record(const SyntheticSize& size, std::size_t index) {
  const Place at = place_of(size, index);
  Record record{.request = request_of(size, at)};
  record.cell = cell_digest(record.request);
  record.build = "a55c84ea1e197cc0";
  record.provenance = provenance_of(index);
  for (const auto& [name, tau] : kVerified)
    record.verified[name] = record.found[name] = std::nullopt;
  if (is_inapplicable(at)) {
    record.status = Status::inapplicable;
    record.message = "a simplex of so many unknowns";
    record.summary = {.start_loss = NAN, .loss = NAN, .best_loss = INFINITY};
    record.summary.start_x_error = record.summary.x_error = record.summary.gradient_norm = NAN;
    record.repeat_wall_seconds = {0};
    return record;
  }
  if (is_declared(at.problem)) record.minimum = 0;
  fill_curve(record, size, at);
  if (record.minimum) record.hits = hits_of(record.curve);
  summarize(record);
  fail_some(record, size, index);
  if (at.optimizer % kMethods.size() == kPrivileged) record.privileges = {"exact Hessian"};
  return record;
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLostOf = 200;  // of so many planned cells of a sample one is missing

void save(const fs::path& file, const Json& json) { std::ofstream(file) << json.dump() << '\n'; }

Sheet sheet_of(const std::string& kind, const Component& of) {
  const bool is_problem = kind == "problem";
  return {.kind = kind,
          .name = of.name,
          .spec = of.spec,
          .title = is_problem ? "An invented inverse problem" : "An invented method",
          .formula = is_problem ? "L = ½‖P(x) − y*‖²" : "θ ← θ + Δθ",
          .source = "none: its runs are drawn",
          .options_text = "[]",
          .family = is_problem ? "" : "first-order",
          .inverse = is_problem ? "none" : "",
          .unknowns = is_problem ? 16 : 0,
          .residuals = is_problem ? 16 : 0};
}

// Two of the problems of a sample are of two dimensions: their sheets have a landscape, and their
// records a path through it.
bool has_path(const SyntheticSize& size, std::size_t problem) {
  return size.is_sample && problem < 2;
}

Landscape bowl() {
  constexpr Index kGrid = 97;
  Landscape bowl{{-0.5, 3.5, -0.5, 3.5}, Grid(kGrid, kGrid)};
  const auto at = [](Index i) { return -0.5 + 4.0 * Real(i) / (kGrid - 1); };
  for (Index j = 0; j < kGrid; ++j)
    for (Index i = 0; i < kGrid; ++i) bowl.loss(i, j) = std::pow(at(i), 2) + std::pow(at(j), 4);
  return bowl;
}

// A forward solve of some microseconds, a Jacobian dearer than declared, an inverse cheaper.
MeasuredPrices prices_of(std::size_t problem) {
  const Real factor = 1 + 0.1 * static_cast<Real>(problem % 7);
  MeasuredPrices prices{"0123456789abcdef",
                        "Intel(R) Xeon(R) Processor @ 2.70GHz",
                        2e-6 * factor,
                        {{"forward", 1, 1, 1, 1, 31, 620}}};
  for (const auto& [oracle, declared, price] :
       {std::tuple{"pullback", 1, 1.3}, {"jacobian", 2, 4.1}, {"inverse", 3, 0.7}})
    prices.oracles.push_back(
        {oracle, declared, price * factor, 0.9 * price * factor, 1.2 * price * factor, 31, 620});
  return prices;
}

void write_sheets(const fs::path& folder, const SyntheticSize& size) {
  const auto write = [&](const Sheet& sheet) {
    save(folder / "components" / sheet.file_name(), to_json(sheet));
  };
  for (std::size_t p = 0; p < size.problems; ++p) {
    Sheet sheet = sheet_of(
        "problem", synthetic_record(size, p * size.optimizers * size.seeds).request.problem);
    if (size.is_sample) sheet.prices = prices_of(p);
    if (has_path(size, p)) {
      sheet.landscape_x = sheet.landscape_y = bowl();
      sheet.truth = sheet.target = {0, 0};
    }
    write(sheet);
  }
  for (std::size_t s = 0; s < size.optimizers; ++s)
    write(sheet_of("optimizer", synthetic_record(size, s * size.seeds).request.optimizer));
}

}  // namespace

void write_synthetic_study(const fs::path& folder, const SyntheticSize& size) {
  for (const char* part : {"runs", "components"}) fs::create_directories(folder / part);
  write_sheets(folder, size);
  Plan plan{.suites = {"synthetic"}, .cells = std::vector<PlannedCell>(size.records())};
  std::atomic<std::size_t> next{0};
  const auto write_some = [&] {
    for (std::size_t i = next++; i < plan.cells.size(); i = next++) {
      Record record = synthetic_record(size, i);
      const Request& request = record.request;
      plan.cells[i] = {record.cell, request.problem.spec, request.optimizer.spec, request.seed};
      if (size.is_sample && i % kLostOf == kLostOf - 1) continue;
      if (has_path(size, place_of(size, i).problem) && !record.curve.loss.empty()) {
        record.trajectory.emplace();
        for (const Real error : record.curve.x_error) {
          record.trajectory->x.push_back({3 * std::min(error, 1.0), 2 * std::min(error, 1.0)});
          record.trajectory->y.push_back({3 * std::min(error, 1.0), 4 * error * error});
        }
      }
      save(folder / "runs" / record.file_name(), to_json(record));
    }
  };
  {
    const std::jthread other(write_some);
    write_some();
  }
  save(folder / "plan.json", to_json(plan));
}

}  // namespace isoline::reports
