// Formulas of component sheets, plain text in Unicode, typeset for browsers.
#pragma once

#include <string>
#include <string_view>

namespace isoline::reports {

// HTML: presentation MathML, with the words between formulas as text so that lines can break there.
// Fractions a/b, roots √, scripts (x₁², Λ^(−κ), R_φ), accents (x̃), fences and named functions are
// set; whatever is not known stands as it is, so that no letter is ever lost.
std::string mathml(std::string_view formula);

}  // namespace isoline::reports
