// The audit's measurements. It grants and counts every oracle, and compares the declarations of a
// method with its calls.
#include "benchmarks/audit/audit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "benchmarks/audit/audit_problems.h"
#include "benchmarks/run/execute.h"
#include "benchmarks/run/isolate.h"
#include "benchmarks/run/keepers/keeper.h"
#include "core/json.h"
#include "core/results/statistics.h"
#include "core/spec.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"

namespace isoline::benchmarks {
namespace {

constexpr std::int64_t kStepsOfPath = 5;    // of invariance: few, so that rounding stays small
constexpr std::int64_t kStepsOfCount = 10;  // of the oracles
constexpr std::int64_t kStepsOfApproach = 1000;

// --- one optimizer under audit: runs of it on any problem, every oracle granted, and counted

struct Path {
  std::vector<Vector> x;  // (n) each, the start first
  OracleCounts counts{};
  std::int64_t iterations = 0;
};

// Keeps θ after every step; for the solver of a library, as many steps as the trace can store.
class Recorded final : public Optimizer {
 public:
  Recorded(Optimizer& method, std::vector<Vector>& path) : method_(method), path_(path) {}
  void start(Meter& f, const Vector& theta) override {
    if (!reports_iterations()) path_.push_back(theta);
    method_.start(f, theta);
  }
  Status step(Meter& f, Vector& theta) override {
    const Status status = method_.step(f, theta);
    if (!reports_iterations()) path_.push_back(theta);
    return status;
  }
  bool reports_iterations() const override { return method_.reports_iterations(); }

 private:
  Optimizer& method_;
  std::vector<Vector>& path_;
};

struct Subject {
  const Catalog& catalog;
  const OptimizerEntry& entry;
  const OptionValues options;

  std::string why_inapplicable(const Problem& problem) const {
    return optimizers::why_inapplicable(entry, options, problem);
  }

  // As far as it comes: a method that throws has gone as far as its trace.
  Path run(const Problem& problem, std::int64_t iterations) const {
    const auto trace = std::make_unique<Trace>();  // large
    OracleSet every_oracle;
    for (const OracleRow& row : kOracleTable) every_oracle.add(row.kind);
    Path path;
    try {
      const auto method = entry.make(options, catalog.optimizers);
      Recorded recorded(*method, path.x);
      Meter meter(problem, {.iterations = iterations, .target = 0}, every_oracle, *trace,
                  open_keepers(*trace));
      Checkpoint checkpoint;
      drive(recorded, meter, problem.start(), checkpoint);
    } catch (const std::exception&) {  // what it did until then is judged
    }
    path.counts = trace->last.counts;
    path.iterations = trace->last.iteration;
    Parts parts;
    write_parts(*trace, parts);
    if (path.x.empty() && parts.trajectory)
      for (const std::vector<Real>& x : parts.trajectory->x)
        path.x.emplace_back(Eigen::Map<const Vector>(x.data(), std::ssize(x)));
    return path;
  }

  // The first step that changes θ; nothing if there is no such step.
  std::optional<Vector> first_step(const Problem& problem) const {
    constexpr std::int64_t kStepsToMove = 8;  // in which a first step may be rejected
    if (!why_inapplicable(problem).empty()) return std::nullopt;
    for (const Vector& x : run(problem, kStepsToMove).x)
      if (x != problem.start()) return x - problem.start();
    return std::nullopt;
  }
};

// --- measurements

Vector gradient_at_start(const Problem& problem) {
  Point at;
  problem.forward(problem.start(), at);
  Matrix g(problem.outputs(), problem.samples());
  problem.cotangent(at, g);
  Vector gradient(problem.unknowns());
  problem.pullback(g, gradient, at);
  return gradient;
}

ScalingLaw scaling_law(const Subject& subject, Problem (*make)(Real)) {
  constexpr int kDecades = 3, kPerDecade = 2;
  ScalingLaw law;
  std::vector<Real> lengths, changes;
  for (int i = -kDecades * kPerDecade; i <= kDecades * kPerDecade; ++i) {
    law.scales.push_back(std::pow(10.0, static_cast<Real>(i) / kPerDecade));
    const Problem problem = make(law.scales.back());
    const auto step = subject.first_step(problem);
    lengths.push_back(step ? step->norm() : kUnknown);
    changes.push_back(step ? std::abs(gradient_at_start(problem).dot(*step)) : kUnknown);
  }
  law.step = power_law(law.scales, std::move(lengths));
  law.loss_change = power_law(law.scales, std::move(changes));
  return law;
}

// The largest distance of the paths, relative to the longer; one that has ended stays where it is.
Real deviation(const std::vector<Vector>& a, const std::vector<Vector>& b) {
  if (a.empty() || b.empty()) return kUnknown;
  Real largest = 0, longest = 0;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const Vector &x = a[std::min(i, a.size() - 1)], &y = b[std::min(i, b.size() - 1)];
    const Real gap = (x - y).norm();
    if (!std::isfinite(gap)) return std::numeric_limits<Real>::infinity();
    largest = std::max(largest, gap);
    longest = std::max({longest, (x - a.front()).norm(), (y - b.front()).norm()});
  }
  return longest > 0 ? largest / longest : kUnknown;
}

// By the path in other units, which is turned back where these are of x.
void measure_changes(const Subject& subject, const Problem& problem,
                     Problem (*changed)(const Change&), bool is_of_x, AuditedOptimizer& audited) {
  const std::vector<Vector> path = subject.run(problem, kStepsOfPath).x;
  for (std::size_t kind = 0; kind < kChanges; ++kind) {
    const Change change = change_of(kind);
    std::vector<Vector> other = subject.run(changed(change), kStepsOfPath).x;
    for (Vector& x : other)
      if (is_of_x) x = change.forward(x);
    audited.deviations[(is_of_x ? 0 : kChanges) + kind] = deviation(path, other);
  }
}

Approach approach(const Subject& subject, const Vicinity& vicinity) {
  constexpr Real kRounding = 1e-14;  // of x of order 1
  std::vector<Real> errors;
  for (const Vector& x : subject.run(vicinity.problem, kStepsOfApproach).x)
    errors.push_back((x - vicinity.solution).norm());
  return approach_of(errors, kRounding);
}

// Between the step that the method takes in z, and what its step in x makes of z.
Real angle(const Subject& subject, const Composition& composition) {
  const auto promised = subject.first_step(composition.inner);
  const auto step = subject.first_step(composition.whole);
  if (!promised || !step) return kUnknown;
  const Vector start = composition.whole.start();
  const Vector made =
      value_of(composition.stage, start + *step) - value_of(composition.stage, start);
  const Real cross = made[0] * (*promised)[1] - made[1] * (*promised)[0];
  return std::atan2(std::abs(cross), made.dot(*promised)) * 180 / std::numbers::pi;
}

void count_oracles(const Subject& subject, const Problem& problem, AuditedOptimizer& audited) {
  const Path path = subject.run(problem, kStepsOfCount);
  const OracleSet declared = needs_of(subject.entry, subject.options, problem);
  audited.iterations = path.iterations;
  for (std::size_t kind = 0; kind < kOracles; ++kind) {
    const std::string name(kOracleNames[kind]);
    const bool is_declared = declared.contains(static_cast<Oracle>(kind));
    if (is_declared) audited.declared.push_back(name);
    if (path.counts[kind] > 0) audited.counted[name] = path.counts[kind];
    if (is_declared && path.counts[kind] == 0)
      audited.flags.push_back(fmt::format("declares that it needs {}, but never called it", name));
    if (!is_declared && path.counts[kind] > 0)
      audited.flags.push_back(fmt::format("called {} without declaring it", name));
  }
}

OptionValues options_without_floors(const OptimizerEntry& entry) {
  OptionValues options;
  for (const OptionField& field : entry.options)
    if ((field.name == "epsilon" || field.name == "cutoff") && contains(field.range, 0))
      options.set(field.name, 0.0);
  return options;
}

void audit_direct(const Subject& subject, AuditedOptimizer& audited) {
  audited.scalings = {scaling_law(subject, scaled_loss), scaling_law(subject, scaled_output),
                      scaling_law(subject, scaled_input), scaling_law(subject, slope)};
  measure_changes(subject, bent_problem(), changed_input, true, audited);
  measure_changes(subject, bent_problem(), changed_output, false, audited);
  audited.regular = approach(subject, regular_vicinity());
  audited.singular = approach(subject, singular_vicinity());
  audited.linear_angle = angle(subject, linear_composition());
  audited.curved_angle = angle(subject, curved_composition());
  count_oracles(subject, bent_problem(), audited);
}

// The measurements that make sense if θ is the weights of a network: no unknown x could change
// units, and no θ is the only solution.
void audit_teacher(const Subject& subject, AuditedOptimizer& audited) {
  audited.network = kTaughtNetwork;
  audited.scalings[static_cast<std::size_t>(Scaled::loss)] = scaling_law(subject, taught_loss);
  audited.scalings[static_cast<std::size_t>(Scaled::output)] = scaling_law(subject, taught_output);
  audited.deviations.fill(kUnknown);
  measure_changes(subject, taught_problem(), taught_change, false, audited);
  count_oracles(subject, taught_problem(), audited);
}

bool is_positive(Real value) { return std::isfinite(value) && value > 0; }

}  // namespace

AuditedOptimizer audit_optimizer(const Catalog& catalog, const std::string& text) {
  const Spec spec = parse_spec(text);
  const std::string& name = spec.name;
  const OptimizerEntry& entry = catalog.optimizers.at(name);
  OptionValues options = options_without_floors(entry);
  options.set_all(options_of(spec));
  const Component component = complete_optimizer(catalog, name, options);
  const Subject subject{catalog, entry, component.options};
  AuditedOptimizer audited{.name = name, .spec = component.spec};
  audited.reason = subject.why_inapplicable(bent_problem());
  if (audited.reason.empty()) {
    audit_direct(subject, audited);
  } else if (subject.why_inapplicable(taught_problem()).empty()) {
    audited.reason.clear();
    audit_teacher(subject, audited);
  } else {
    return audited;
  }
  // Declared of rescaled inputs, component by component, at default options: the first of the
  // changes. To keep more than was declared is no false declaration.
  const Real found = audited.deviations.front();
  const bool has_defaults = options_of(spec).empty();
  if (entry.is_input_scale_invariant && has_defaults && found > kInvariantDeviation)
    audited.flags.push_back(fmt::format(
        "declares that rescaled inputs do not change its path, but they move it by {:.2g}", found));
  return audited;
}

std::vector<AuditedOptimizer> audit_all(const Catalog& catalog,
                                        const std::vector<std::string>& names) {
  constexpr double kAuditSeconds = 60;  // an optimizer; nearly all take a hundredth of a second
  std::vector<AuditedOptimizer> all;
  for (const std::string& name : names) {
    const auto [text, failure, is_interrupted] = isolated_text(
        [&] { return json_text(to_json(audit_optimizer(catalog, name))); }, kAuditSeconds);
    if (text)
      all.push_back(audited_from_text(*text, name));
    else
      all.push_back({.name = name,
                     .spec = name,
                     .reason = fmt::format("its audit did not finish: {}", failure)});
  }
  return all;
}

std::string audit_text(const std::vector<AuditedOptimizer>& all) {
  return json_text(audit_to_json(all), 2) + "\n";
}

void write_audit(const std::vector<AuditedOptimizer>& all, const std::filesystem::path& path) {
  write_json(path, audit_to_json(all));
}

PowerLaw power_law(const std::vector<Real>& scales, std::vector<Real> values) {
  PowerLaw law{.values = std::move(values)};
  if (std::ranges::all_of(law.values, is_positive))
    std::tie(law.exponent, law.residual) = results::log_slope(scales, law.values);
  return law;
}

Approach approach_of(const std::vector<Real>& errors, Real floor) {
  constexpr Real kNear = 0.1;  // what has not come ten times nearer shows no order
  Approach approach;
  if (errors.size() < 2 || !is_positive(errors.front())) return approach;
  std::vector<Real> before, after;
  for (std::size_t i = 1; i < errors.size(); ++i) {
    approach.steps = static_cast<std::int64_t>(i);
    approach.is_exact = errors[i] <= floor;
    if (approach.is_exact) break;
    if (!(errors[i] < errors[i - 1])) continue;  // a rejected step, or the wrong way
    before.push_back(errors[i - 1]);
    after.push_back(errors[i]);
  }
  const Real last =
      approach.is_exact ? errors[static_cast<std::size_t>(approach.steps)] : errors.back();
  approach.remaining = std::isfinite(last) ? last / errors.front() : kUnknown;
  if (before.size() >= 2 && approach.remaining <= kNear)
    std::tie(approach.order, approach.residual) = results::log_slope(before, after);
  return approach;
}

}  // namespace isoline::benchmarks
