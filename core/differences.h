// The noise in the values of a function, and the steps of differences that follow from it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/array.h"

namespace isoline {

// The noise in values of f, by ECNoise: difference tables of kNoiseCalls values along a line, from
// which the values of a smooth function vanish; Moré, Wild (2011), SIAM J. Sci. Comput. 33, section
// 5. `f`: t -> (m). The standard deviation per component; 0 where none is found. Where the spacing
// is too small or too large for a result, it is changed, at most `kNoiseSpacings` times.
inline constexpr int kNoiseCalls = 7, kNoiseSpacings = 4;
Vector noise_of_values(const std::function<Vector(Real t)>& f);

// Steps relative to the size of an unknown, for a function whose derivatives are those of y over
// that size: h = 8^¼ √ε of forward, and (3ε)^⅓ of central differences, with the relative noise ε;
// Moré, Wild (2012), ACM TOMS 38.
Real forward_step(Real noise);
Real central_step(Real noise);

// The size of an unknown that a step is relative to, where the column of J has this norm: y bends
// as an exponential or a wave of it does, ‖J‖²/‖y‖, where the column is large, else as a term of a
// sum, ‖J‖ over the size.
Real size_for_steps(Real size, Real column, Real size_of_y);

// Steps as a user gives them: one number, or one for each unknown with colons between, relative to
// the sizes of the unknowns; or in their units, where "absolute" follows: "1e-3", "0.1:2 absolute".
struct GivenSteps {
  std::vector<Real> steps = {};  // none: they follow from the noise
  bool are_absolute = false;

  // h of unknown j of n, of which there are as many steps or one; `otherwise` where none is given,
  // in sizes. UsageError for another number of steps.
  Real of(Index j, Index n, Real size, Real otherwise) const;
};
GivenSteps given_steps(const std::string& text);  // UsageError for any other text
inline constexpr const char* kStepHelp =
    "of differences: the step, relative to the size of each unknown, or in its units as "
    "\"0.1 absolute\"; one number, or one for each unknown as 1e-3:0.1:1e-3; empty: it follows from "
    "the noise of y";

// The size of each unknown: |x₀|, or that of the largest, at most 1, where x₀ = 0.
Vector sizes_of_unknowns(const Vector& start);

// The noise of y in a call, relative to ‖y‖, at least rounding: by three to five calls y(t) at t >
// 0 along a line through the point where y is `y0`; t in sizes of the unknowns. What near calls
// differ by from a smooth y, and what is not smooth at two or three steps farther away, as of an
// adaptive solver, whose values jump where the number of its steps does; the larger one holds. And
// the last place of values that were printed with few digits or are of single precision, which
// small steps do not show. `factors`: by which the first rows of y were multiplied after they were
// printed; the others were not. `slope`: dy/dt at 0, (m), by the nearest; empty where y has noise.
Real noise_of_calls(const Vector& y0, const std::function<Vector(Real t)>& y, const Vector& factors,
                    Vector* slope = nullptr);
// t of the first calls: no round numbers, at which y would seem printed with few digits.
inline constexpr Real kNoiseStep = 1.0471975511965976e-3;
inline constexpr std::array<Real, 3> kNoiseSteps = {kNoiseStep, 2 * kNoiseStep, 1e-8};

// The direction of those calls, (n), in sizes of the unknowns; towards the inside at a bound. No
// bounds: nullptr.
Vector line_inside(const Vector& start, const Vector& sizes, const Vector* lower,
                   const Vector* upper);

// The offsets of the calls of a difference quotient: h; h and −h; or, where a bound is nearer than
// that, inward, with two calls of second order. `up`, `down`: the room for t and −t. The second is
// 0 where one call is enough; both are 0 where there is no room.
std::array<Real, 2> difference_offsets(Real h, bool is_central, Real up, Real down);

// The room for t and −t along an unknown, or along a direction; infinite where there is no bound.
struct Room {
  Real up = std::numeric_limits<Real>::infinity(), down = up;
};
// dy/dt at 0 from y there and at the offsets; `second` is not used where its offset is 0.
template <class Array>
auto difference_quotient(const std::array<Real, 2>& at, const Array& y0, const Array& first,
                         const Array& second) {
  const auto [a, b] = at;
  if (b == 0) return Array((first - y0) / a);
  return Array((b * b * (first - y0) - a * a * (second - y0)) / (a * b * (b - a)));
}

// dy/dt at 0 by calls y(t) at these offsets, of which y(t) may round t. Where no call has a value,
// the other side is tried if there is room, and then shorter steps; without any, 0. Of two, a call
// nearer than the failed one stands in for it, or one halfway to the other.
template <class Array>
Array quotient_of_calls(const std::array<Real, 2>& offsets, const Room& room, const Array& y0,
                        const auto& y) {
  std::array<Real, 2> at{};
  std::array<Array, 2> values;
  std::size_t count = 0;
  const auto take = [&](Real t) {
    values[count] = y(t);
    at[count] = t;
    const bool has_value = values[count].allFinite();
    count += has_value;
    return has_value;
  };
  Real failed = 0;
  for (const Real t : offsets)
    if (t != 0 && !take(t)) failed = t;
  constexpr Real kNearer = 0.8;  // a call beside the one that failed has less noise in the quotient
  if (count == 1 && failed != 0) take(kNearer * failed);
  constexpr Real kShortest = 0.1;  // of the step
  for (Real share = 1; count == 0 && share > kShortest; share /= 2)
    for (const Real t : {share * offsets[0], -share * offsets[0]}) {
      const bool is_known = t == 0 || (share == 1 && (t == offsets[0] || t == offsets[1]));
      if (count == 0 && !is_known && std::abs(t) <= (t > 0 ? room.up : room.down)) take(t);
    }
  if (count == 1 && offsets[1] != 0) take(at[0] / 2);  // of second order still, on one side
  if (count == 0) return Array::Zero(y0.rows(), y0.cols());
  if (count == 1) at[1] = 0;
  return difference_quotient<Array>(at, y0, values[0], values[1]);
}

// "x3", or the unknown's own name. `names`: (n), or empty.
std::string name_of_unknown(const std::vector<std::string>& names, Index i);

}  // namespace isoline
