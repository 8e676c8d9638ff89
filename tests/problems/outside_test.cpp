// Problems with answers from outside: NIST's certified regressions, and the cases of Moré and Wild.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "make.h"
#include "problems/problem.h"
#include "tests/problems/make.h"

namespace isoline::problems {
namespace {

std::vector<std::string> datasets() {
  for (const OptionField& field : all_problems().at("nist").options)
    if (field.name == "dataset") return field.choices;
  return {};
}

// Lanczos1's certified sum, 1e-25, is below what double precision attains at its parameters.
TEST(Nist, SumsOfSquaresAtTheCertifiedParametersAreTheCertifiedOnes) {
  ASSERT_EQ(datasets().size(), 27u);
  for (const std::string& name : datasets()) {
    const Problem problem = make("nist[dataset=" + name + "]");
    const Real loss = loss_at(problem, problem.truth()->reshaped());
    if (name == "Lanczos1")
      EXPECT_LT(loss, 1e-20);
    else
      EXPECT_NEAR(loss / *problem.minimum(), 1, 1e-9) << name;
  }
}

TEST(MoreWild, SumsOfSquaresAtTheStartsAreThePublishedOnes) {
  const std::vector<std::pair<std::string, Real>> published = {
      {"linear-full-rank-good-start", 72},
      {"linear-full-rank-bad-start", 1125},
      {"linear-rank-one-good-start", 1.165420e7},
      {"linear-rank-one-bad-start", 1.168591e9},
      {"linear-rank-one-zeros-good-start", 4.989195e6},
      {"linear-rank-one-zeros-bad-start", 5.009356e8},
      {"rosenbrock-good-start", 24.2},
      {"rosenbrock-bad-start", 1.795769e6},
      {"helical-valley-good-start", 2500},
      {"helical-valley-bad-start", 10600},
      {"powell-singular-good-start", 215},
      {"powell-singular-bad-start", 1.615400e6},
      {"freudenstein-roth-good-start", 400.5},
      {"freudenstein-roth-bad-start", 1.545754e8},
      {"bard-good-start", 41.68170},
      {"bard-bad-start", 1306.234},
      {"kowalik-osborne", 5.313172e-3},
      {"meyer", 1.693608e9},
      {"watson-6-good-start", 16.43083},
      {"watson-6-bad-start", 2.323367e6},
      {"watson-9-good-start", 26.90417},
      {"watson-9-bad-start", 8.158877e6},
      {"watson-12-good-start", 73.67821},
      {"watson-12-bad-start", 2.059384e7},
      {"box-3d", 1031.154},
      {"jennrich-sampson", 4171.306},
      {"brown-dennis-good-start", 7.926693e6},
      {"brown-dennis-bad-start", 3.081064e11},
      {"chebyquad-6", 4.642817e-2},
      {"chebyquad-7", 3.377064e-2},
      {"chebyquad-8", 3.861770e-2},
      {"chebyquad-9", 2.888298e-2},
      {"chebyquad-10", 3.376327e-2},
      {"chebyquad-11", 2.674060e-2},
      {"brown-almost-linear", 273.2480},
      {"osborne-one", 16.17411},
      {"osborne-two-good-start", 2.093420},
      {"osborne-two-bad-start", 199.6847},
      {"bdqrtic-8", 904},
      {"bdqrtic-10", 1356},
      {"bdqrtic-11", 1582},
      {"bdqrtic-12", 1808},
      {"cube-5", 56.5},
      {"cube-6", 70.5625},
      {"cube-8", 98.6875},
      {"mancino-5-good-start", 2.539084e9},
      {"mancino-5-bad-start", 6.873795e12},
      {"mancino-8", 3.367961e9},
      {"mancino-10", 3.735127e9},
      {"mancino-12-good-start", 3.991072e9},
      {"mancino-12-bad-start", 1.130015e13},
      {"heart-eight-good-start", 9.385672},
      {"heart-eight-bad-start", 3.365815e10},
      {"brown-almost-linear-medium", 2.524757e5}};
  ASSERT_EQ(published.size(), 54u);
  constexpr Real kSevenDigits = 1e-6;
  for (const auto& [name, f] : published)
    EXPECT_NEAR(2 * loss_at_start(make("more-wild[case=" + name + "]")) / f, 1, kSevenDigits)
        << name;
}

}  // namespace
}  // namespace isoline::problems
