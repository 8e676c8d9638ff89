// Formulas as MathML: each construction of the sheets, and what is not one.
#include "reports/html/mathml.h"

#include <gtest/gtest.h>

namespace isoline::reports {
namespace {

std::string math(const std::string& content) { return "<math>" + content + "</math>"; }

TEST(Mathml, ScriptsOfALetterAreItsOwn) {
  EXPECT_EQ(mathml("x₁²"),
            math("<msubsup><mi>x</mi><mrow><mn>1</mn></mrow><mrow><mn>2</mn></mrow></msubsup>"));
  EXPECT_EQ(mathml("H⁻¹"), math("<msup><mi>H</mi><mrow><mo>−</mo><mn>1</mn></mrow></msup>"));
  EXPECT_EQ(mathml("y*"), math("<msup><mi>y</mi><mrow><mo>*</mo></mrow></msup>"));
  EXPECT_EQ(mathml("R_φ"), math("<msub><mi>R</mi><mrow><mi>φ</mi></mrow></msub>"));
}

TEST(Mathml, AnExponentInParenthesesLosesThem) {
  EXPECT_EQ(mathml("Λ^(−κ)"), math("<msup><mi>Λ</mi><mrow><mrow><mo form=prefix>−</mo><mi>κ</mi>"
                                   "</mrow></mrow></msup>"));
}

TEST(Mathml, AFractionTakesWhatStandsWithoutABlank) {
  EXPECT_EQ(mathml("η ∇L/(s + ε)"),
            math("<mi>η</mi><mfrac><mrow><mi>∇</mi><mi>L</mi></mrow><mrow><mi>s</mi><mo>+</mo>"
                 "<mi>ε</mi></mrow></mfrac>"));
}

TEST(Mathml, ARootCoversItsAccentedLetter) {
  EXPECT_EQ(mathml("√v̂"), math("<msqrt><mover accent=true><mi>v</mi><mo stretchy=false>^</mo>"
                               "</mover></msqrt>"));
}

TEST(Mathml, ProseStandsBesideTheFormula) {
  EXPECT_EQ(mathml("B ≈ H by rank-two updates, dense"),
            math("<mi>B</mi><mo>≈</mo><mi>H</mi>") + " by rank-two updates, dense");
  EXPECT_EQ(mathml("min of a quadratic"), "min of a quadratic");
}

TEST(Mathml, ForeignTextStaysText) {
  const std::string html = mathml("<b>&|\"x\"</script> ‖ ( [");
  EXPECT_EQ(html.find("<b>"), std::string::npos);
  EXPECT_EQ(html.find("</script>"), std::string::npos);
  EXPECT_EQ(mathml(""), "");
}

}  // namespace
}  // namespace isoline::reports
