// The products of a point, each of which the meter charges for.
#include "optimizers/linearization.h"

#include "optimizers/meter.h"

namespace isoline::optimizers {

const Problem& Linearization::ask(Oracle oracle) {
  meter_->charge(oracle);
  meter_->ledger_.share_product(oracle);
  return meter_->problem_;
}

const Matrix& Linearization::once(Oracle oracle, bool& is_there, Matrix& out) {
  if (is_there) return out;
  const Problem& problem = ask(oracle);
  oracle == Oracle::jacobian ? problem.jacobian(out, point_) : problem.hessian(out, point_);
  is_there = true;
  return out;
}

void Linearization::gradient(Vector& out) {
  cotangent(g_);
  out.resize(problem_->unknowns());
  pullback(g_, out);
}

}  // namespace isoline::optimizers
