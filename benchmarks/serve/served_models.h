// A problem P as four models of UM-Bridge:
//
//   P            x ↦ y
//   P.loss       x ↦ L(y, y*)
//   P.inverse    (y, x₀) ↦ the x nearest x₀ with P(x) = y; where the physics has an inverse
//   P.data       nothing ↦ (y*, x₀): what is sought, and where every method begins
#pragma once

#include <string>
#include <vector>

#include "benchmarks/serve/served_run.h"
#include "core/bridge_messages.h"

namespace isoline::benchmarks {

enum class View { physics, loss, inverse, data };

class ServedModels {
 public:
  explicit ServedModels(ServedRun& run);

  std::vector<View> views() const;
  std::string name_of(View view) const;  // "rosenbrock.loss"
  BridgeSizes sizes(View view) const;
  BridgeSupport support(View view) const;

  void require_offered(View view, BridgeVerb verb) const;  // BridgeRefusal where it is not

  // The answer's text; one at a time. BridgeRefusal where the model has no value there.
  std::string answer(View view, const BridgeCall& call);

 private:
  std::vector<Numbers> evaluate(View view, const BridgeCall& call);
  Numbers gradient(View view, const BridgeCall& call);
  Numbers apply_jacobian(View view, const BridgeCall& call);
  Numbers apply_hessian(View view, const BridgeCall& call);
  Numbers invert(const BridgeCall& call);

  ServedRun& run_;
  const Problem& problem_;
};

}  // namespace isoline::benchmarks
