// The data of a fit: of a user's own program, or of a problem with the words of a model.
#pragma once

#include <vector>

#include "core/errors.h"
#include "core/real.h"
#include "core/records/part.h"

namespace isoline {

// And y at the returned point, in the units of the data.
struct FitData {
  static constexpr Part kPart{
      .member = "fit",
      .law = R"({"description": "The data of a fit, and y at the returned point"})"};
  std::vector<Real> target, y;
  std::vector<Real> sigma = {};  // standard deviations; empty where they are unknown
};

void fields(Like<FitData> auto& fit, auto& field) {
  field("target", fit.target);
  field("y", fit.y);
  field.optional("sigma", fit.sigma, R"({"description": "Standard deviations of the data"})");
}

inline void require_sound(const FitData& fit) {
  const std::size_t data = fit.target.size();
  require(fit.y.size() == data && (fit.sigma.empty() || fit.sigma.size() == data),
          "the columns of its data differ in length");
}

}  // namespace isoline
