// The oracles of a problem in UM-Bridge's words.
#include "benchmarks/serve/served_models.h"

#include <algorithm>

namespace isoline::benchmarks {
namespace {

// Above these the matrices behind a product with the curvature are not formed.
constexpr Index kMostBent = 256;

constexpr std::string_view kSuffix[] = {"", ".loss", ".inverse", ".data"};

Vector vector_of(const Numbers& values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

Numbers numbers_of(VectorRef values) { return {values.data(), values.data() + values.size()}; }

}  // namespace

ServedModels::ServedModels(ServedRun& run) : run_(run), problem_(run.problem()) {}

std::vector<View> ServedModels::views() const {
  if (problem_.inverse_kind() == Inverse::none) return {View::physics, View::loss, View::data};
  return {View::physics, View::loss, View::inverse, View::data};
}

std::string ServedModels::name_of(View view) const {
  return run_.request().problem.spec + std::string(kSuffix[static_cast<std::size_t>(view)]);
}

BridgeSizes ServedModels::sizes(View view) const {
  const Index k = problem_.inputs(), m = problem_.outputs();
  switch (view) {
    case View::loss:
      return {{k}, {1}};
    case View::inverse:
      return {{m, k}, {k}};
    case View::data:
      return {{}, {m, k}};
    default:
      return {{k}, {m}};
  }
}

BridgeSupport ServedModels::support(View view) const {
  const OracleSet offered = problem_.offers();
  const bool is_differentiable = view == View::physics || view == View::loss;
  const bool is_bent = view == View::physics
                           ? offered.contains(Oracle::curvature) && problem_.inputs() <= kMostBent
                           : offered.contains(Oracle::hessian_product);
  return {true, is_differentiable && offered.contains(Oracle::pullback),
          is_differentiable && offered.contains(Oracle::pushforward), is_differentiable && is_bent};
}

void ServedModels::require_offered(View view, BridgeVerb verb) const {
  if (!support(view)[static_cast<std::size_t>(verb)])
    throw BridgeRefusal("UnsupportedFeature",
                        name_of(view) + " does not offer " + isoline::name_of(verb));
}

std::string ServedModels::answer(View view, const BridgeCall& call) {
  switch (call.verb) {
    case BridgeVerb::gradient:
      return output_text(gradient(view, call));
    case BridgeVerb::apply_jacobian:
      return output_text(apply_jacobian(view, call));
    case BridgeVerb::apply_hessian:
      return output_text(apply_hessian(view, call));
    default:
      return outputs_text(evaluate(view, call));
  }
}

std::vector<Numbers> ServedModels::evaluate(View view, const BridgeCall& call) {
  if (view == View::data)
    return {numbers_of(problem_.target().reshaped()), numbers_of(problem_.start())};
  if (view == View::inverse) return {invert(call)};
  const Linearization& at = run_.at(vector_of(call.input[0]));
  if (view == View::loss) return {{at.loss()}};
  return {numbers_of(at.y().reshaped())};
}

Numbers ServedModels::invert(const BridgeCall& call) {
  const Vector y = vector_of(call.input[0]);
  Linearization& at = run_.at(vector_of(call.input[1]));
  Matrix x(problem_.inputs(), 1);
  const Success success = at.local_inverse(y, x);
  if (!success[0])
    throw BridgeRefusal("InvalidInput", "no x near x₀ was found whose P(x) is that y");
  return numbers_of(x.reshaped());
}

// Of a loss, its one cotangent times ∇L.
Numbers ServedModels::gradient(View view, const BridgeCall& call) {
  Linearization& at = run_.at(vector_of(call.input[0]));
  Vector out(problem_.unknowns());
  if (view == View::physics) {
    at.pullback(vector_of(call.sens), out);
  } else {
    at.gradient(out);
    out *= call.sens[0];
  }
  return numbers_of(out);
}

Numbers ServedModels::apply_jacobian(View view, const BridgeCall& call) {
  Linearization& at = run_.at(vector_of(call.input[0]));
  const Vector v = vector_of(call.vec);
  if (view == View::loss) {
    Vector gradient;
    at.gradient(gradient);
    return {gradient.dot(v)};
  }
  Matrix out(problem_.outputs(), 1);
  at.pushforward(v, out);
  return numbers_of(out.reshaped());
}

Numbers ServedModels::apply_hessian(View view, const BridgeCall& call) {
  Linearization& at = run_.at(vector_of(call.input[0]));
  const Vector v = vector_of(call.vec);
  Vector out(problem_.unknowns());
  if (view == View::loss) {
    at.hessian_product(v, out);
    out *= call.sens[0];
  } else {
    Matrix bent(problem_.inputs(), problem_.inputs());
    at.curvature(vector_of(call.sens), bent);
    out = bent * v;
  }
  return numbers_of(out);
}

}  // namespace isoline::benchmarks
