// The words of a model fit, as options of any direct problem: unknowns that are fixed, tied to
// others or seen by their logarithm, the standard deviations of the data, weights, priors, and
// starts spread over the bounds.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/options.h"
#include "problems/problem.h"

namespace isoline::problems {

struct ModelWords {
  std::string fixed, tied, log, sigma, weights, prior, axis;
  Index starts = 0;

  bool is_empty() const {
    return fixed.empty() && tied.empty() && log.empty() && sigma.empty() && weights.empty() &&
           prior.empty() && starts == 0;  // the axis is for pictures alone
  }
};
inline void fields(ModelWords& o, auto& field) {
  field("fixed", o.fixed, {},
        "unknowns that keep their value at the start, or another: \"k1; k2=3\"");
  field("tied", o.tied, {}, "unknowns computed from others: \"k3 = 2 * k1; k4 = exp(-k1)\"");
  field("log", o.log, {}, "positive unknowns that methods see by their logarithm: \"k1; k2\"");
  field(
      "sigma", o.sigma, {},
      "standard deviation of the data, in their units: one number, one per datum, or a file; each "
      "residual is divided by it");
  field("weights", o.weights, {},
        "factors of the residuals, of unknown scale: one number per datum, or a file");
  field("prior", o.prior, {},
        "normal distributions of unknowns, mean and standard deviation: \"k1 = 240 ± 2\"");
  field(
      "axis", o.axis, {},
      "where the data were measured, for the picture of the fit: \"its name; name of the data; one number per "
      "datum\"");
  field("starts", o.starts, between(0, 100'000),
        "starts 1 to N − 1 are a Latin hypercube over the bounds; 0: near the standard start");
}

// UsageError unless these are one positive number for all of m data, or one for each.
void require_factors(std::span<const Real> numbers, std::string_view what, Index m);

// Without `starts`, fixed and tied unknowns are no unknowns of the method, others keep their order.
// The target of a residual is y*/σ; of a prior, which is a row below the data, 0. UsageError for a
// name that the problem does not have, for a start that has no logarithm, for sizes that disagree,
// for `prior` without `sigma`, and for `starts` without finite bounds.
Problem with_model(Problem plain, const ModelWords& words, const Draw& draw);

// By which each y of the simulator is multiplied: those of the model, or else 1 in so many `rows`,
// which are those of data, without priors and penalties.
Vector factors_of_data(const Physics& physics, Index rows);
// x at θ, of a physics with a model.
Vector point_of_model(const Physics& physics, VectorRef theta);
// As Problem::given_step(), in units in which methods see it.
Real given_step(const GivenSteps& given, const Physics& physics, VectorRef theta, Index j,
                Real size, Real otherwise);
// Whether an unknown of the methods is a logarithm.
bool is_logarithm(const Problem& problem, Index unknown);

}  // namespace isoline::problems
