// The audit: its problems are as declared, known power laws are recovered, a false declaration is
// found, and a crash affects one audit only.
#include "benchmarks/audit/audit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>

#include "benchmarks/audit/audit_problems.h"
#include "benchmarks/plan/catalog.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "optimizers/optimizer.h"
#include "problems/conformance.h"
#include "problems/problem.h"
#include "tests/benchmarks/builtin.h"

namespace isoline::benchmarks {

using optimizers::Linearization;
using optimizers::Meter;
using optimizers::stepper_entry;
namespace {

AuditedOptimizer audited(const std::string& name) { return audit_optimizer(catalog(), name); }

TEST(AuditProblems, HoldWhatEveryProblemMust) {
  RandomStream stream(0, "audit", "check");
  for (const Problem& problem :
       {scaled_output(3), changed_input(change_of(2)), changed_output(change_of(1)),
        curved_composition().whole, linear_composition().whole, taught_change(change_of(2))})
    for (const problems::Finding& finding : problems::examine(problem, stream))
      EXPECT_TRUE(finding.holds()) << finding.property << " " << finding.figure;
}

TEST(AuditFits, RecoverAPowerAndSayWhereThereIsNone) {
  const std::vector<Real> scales = {0.01, 0.1, 1, 10};
  const PowerLaw power = power_law(scales, {2e-4, 2e-2, 2, 200});
  EXPECT_NEAR(power.exponent, 2, 1e-12);  // rounding
  EXPECT_TRUE(power.holds());
  EXPECT_FALSE(power_law(scales, {1, 2, 2, 1}).holds());
  for (const Real gap : {kUnknown, 0.0}) {  // no step at one of the scales
    const std::vector<Real> values = {1, 1, 1, gap};
    const PowerLaw incomplete = power_law(scales, values);
    EXPECT_FALSE(incomplete.holds()) << incomplete.exponent << " " << incomplete.residual;
    EXPECT_TRUE(std::isnan(incomplete.exponent)) << gap;
  }
}

TEST(AuditFits, RecoverAnOrderFromItsOwnSequence) {
  const Approach quadratic = approach_of({1e-1, 1e-2, 1e-4, 1e-8, 1e-16}, 1e-14);
  EXPECT_NEAR(quadratic.order, 2, 1e-12);
  EXPECT_TRUE(quadratic.is_exact);
  EXPECT_EQ(quadratic.steps, 4);
  EXPECT_NEAR(approach_of({1, 0.5, 0.25, 0.125, 0.0625, 0.03125}, 1e-14).order, 1, 1e-12);
  EXPECT_TRUE(std::isnan(approach_of({1, 0.9, 0.8, 0.7}, 1e-14).order)) << "it is not near yet";
  EXPECT_TRUE(approach_of({0.1, 0}, 1e-14).is_exact);
}

// The exponents that follow from the formulas: of the loss, the output and the input, and of L = αx
// where there is a law. The loss change adds 1, 2 and 1, and of L = αx one.
struct Law {
  std::string name;
  Real loss, output, input, slope;
};

TEST(Audit, RecoversTheExponentsOfTheory) {
  constexpr Real kTolerance = 0.02, kKappa = 0.5;
  const std::vector<Law> laws = {{"gd", 1, 2, 1, 1},
                                 {"adam", 0, 0, 0, 0},
                                 {"newton", 0, 0, -1, kUnknown},  // its Hessian of L = αx is zero
                                 {"gauss-newton", 0, 0, -1, -1},
                                 {"inverse-gradient", 0, 0, -1, -1},
                                 {"sip", 0, 0, -1, -1},
                                 {"hig", 1, 1 - kKappa, -kKappa, -kKappa}};
  for (const Law& law : laws) {
    const AuditedOptimizer found = audited(law.name);
    const std::array<Real, 4> step = {law.loss, law.output, law.input, law.slope};
    const std::array<Real, 4> added = {1, 2, 1, 1};
    for (std::size_t i = 0; i < step.size(); ++i) {
      const ScalingLaw& scaling = found.scalings[i];
      EXPECT_EQ(scaling.step.holds(), !std::isnan(step[i])) << law.name << kScalingNames[i];
      if (std::isnan(step[i])) continue;
      EXPECT_NEAR(scaling.step.exponent, step[i], kTolerance) << law.name << kScalingNames[i];
      EXPECT_NEAR(scaling.loss_change.exponent, step[i] + added[i], kTolerance) << law.name;
    }
  }
  const PowerLaw none = audited("adamw").law(Scaled::input).step;  // its decay knows no units
  EXPECT_TRUE(none.has_values());
  EXPECT_FALSE(none.holds());
}

TEST(Audit, MeasuresWhatEachMethodIsKnownFor) {
  const AuditedOptimizer gd = audited("gd"), newton = audited("newton"), sip = audited("sip"),
                         gauss_newton = audited("gauss-newton");
  for (const Real deviation : gauss_newton.deviations) EXPECT_LE(deviation, 1e-9);
  EXPECT_GT(gd.deviations[0], 0.1) << "diagonal changes of x";
  EXPECT_LE(gd.deviations[1], 1e-9) << "rotations of x";
  EXPECT_LE(newton.deviations[2], 1e-9) << "affine changes of x";
  EXPECT_GT(newton.deviations[3], 0.01) << "diagonal changes of y";
  EXPECT_NEAR(newton.regular.order, 2, 0.1) << "quadratic";
  EXPECT_NEAR(newton.singular.order, 1, 0.1) << "linear at a singular Hessian";
  EXPECT_NEAR(gd.regular.order, 1, 0.1);
  EXPECT_TRUE(sip.regular.is_exact && sip.regular.steps == 1);
  EXPECT_LE(newton.linear_angle, 1e-6);
  EXPECT_GT(gd.linear_angle, 1);
  EXPECT_LE(sip.curved_angle, 1e-6);
  EXPECT_TRUE(sip.counted.contains("inverse"));
  EXPECT_FALSE(gd.counted.contains("jacobian"));
}

// Supervised training never sees y: its labels are in x, its steps Adam's.
TEST(Audit, TeachesANetworkToMethodsThatNeedOne) {
  const AuditedOptimizer supervised = audited("supervised"), kfac = audited("kfac");
  for (const Scaled scaled : {Scaled::loss, Scaled::output}) {
    EXPECT_NEAR(supervised.law(scaled).step.exponent, 0, 0.02);
    EXPECT_TRUE(supervised.law(scaled).step.holds());
    EXPECT_TRUE(kfac.law(scaled).step.has_values());
  }
  for (std::size_t i = 3; i < 6; ++i) EXPECT_LE(supervised.deviations[i], kInvariantDeviation);
  EXPECT_TRUE(supervised.counted.contains("truth"));
  EXPECT_GT(kfac.deviations[3], kInvariantDeviation) << "diagonal changes of y";
  for (const AuditedOptimizer* each : {&supervised, &kfac}) {
    EXPECT_TRUE(std::isnan(each->deviations[0]) && std::isnan(each->linear_angle)) << each->name;
    EXPECT_FALSE(each->law(Scaled::input).step.has_values());
    EXPECT_EQ(each->iterations, 10);
  }
}

TEST(Audit, FindsNoFalseDeclarationInTheRegistryAndTwiceGivesTheSameBytes) {
  const auto everything = [] { return audit_all(catalog(), catalog().optimizers.ready().names()); };
  const std::vector<AuditedOptimizer> all = everything();
  EXPECT_EQ(all.size(), catalog().optimizers.ready().size());
  for (const AuditedOptimizer& each : all) {
    EXPECT_EQ(each.flags, std::vector<std::string>{}) << each.name;
    EXPECT_EQ(each.reason, "") << each.name;
    constexpr std::array kNeedNetworks = {"kfac", "muon", "soap", "supervised", "two-stage"};
    const bool needs_network = std::ranges::find(kNeedNetworks, each.name) != kNeedNetworks.end();
    EXPECT_EQ(!each.network.empty(), needs_network) << each.name;
  }
  const Json json = audit_to_json(all);
  EXPECT_EQ(schema_violations(json, schema("audit")), std::vector<std::string>{});
  EXPECT_EQ(audit_to_json(audit_from_text(json.dump(), "it")), json);
  EXPECT_EQ(audit_to_json(everything()).dump(), json.dump());
}

// --- methods that do not keep what they declare

// Gradient descent.
struct Boaster {
  Real rate = 1e-2;
  struct State {
    Linearization at;
    Vector gradient;
  };
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    theta -= rate * s.gradient;
    return Status::running;
  }
};
void fields(Boaster& o, auto& field) { field("rate", o.rate, above(0), "step length η"); }

// Crashes, or leaves as if all were well.
template <bool crashes>
struct Leaver {
  struct State {};
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter&, Vector&, State&) const {
    if (crashes) std::raise(SIGKILL);
    std::exit(0);
  }
};
template <bool crashes>
void fields(Leaver<crashes>&, auto&) {}

Catalog catalog_with_liars() {
  Catalog catalog = builtin_catalog();
  catalog.optimizers.add(stepper_entry<Boaster>({.name = "boaster",
                                                 .needs = {Oracle::forward, Oracle::hessian},
                                                 .is_input_scale_invariant = true}));
  catalog.optimizers.add(stepper_entry<Leaver<true>>({.name = "crasher"}));
  catalog.optimizers.add(stepper_entry<Leaver<false>>({.name = "leaver"}));
  return catalog;
}

TEST(Audit, FlagsAFalseDeclaration) {
  const AuditedOptimizer found = audit_optimizer(catalog_with_liars(), "boaster");
  ASSERT_EQ(found.flags.size(), 3U);
  EXPECT_TRUE(found.flags[0].starts_with("called pullback "));
  EXPECT_NE(found.flags[1].find(" hessian,"), std::string::npos);
  EXPECT_TRUE(found.flags[2].starts_with("declares that rescaled inputs "));
}

TEST(Audit, ACrashOrALeaveCostsItsOwnAuditAlone) {
  const auto all = audit_all(catalog_with_liars(), {"crasher", "leaver", "gd"});
  ASSERT_EQ(all.size(), 3U);
  EXPECT_NE(all[0].reason.find("signal"), std::string::npos) << all[0].reason;
  EXPECT_NE(all[1].reason.find("without an answer"), std::string::npos) << all[1].reason;
  EXPECT_EQ(all[2].reason, "");
  EXPECT_EQ(schema_violations(audit_to_json(all), schema("audit")), std::vector<std::string>{});
}

}  // namespace
}  // namespace isoline::benchmarks
