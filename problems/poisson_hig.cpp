// The Poisson problem of Schnell, Holl, Thuerey (2022), published scripts: a network sees y* and
// finds x with ∇²x = y* on 8×8 cells, judged by ∇²x, so the physics is y = ∇²x, five points, with a
// value 0 one width beyond the first and last cell, and its inverse the solve. x* is PhiFlow's
// noise of smoothness 1: white noise over |k|², without its mean, of standard deviation 1. The
// scripts sum the loss over the batch, here it is the mean: their step 0.01 at B = 64 is 0.64 here.
#include "problems/exact_data.h"
#include "problems/laplacian.h"
#include "problems/learning.h"
#include "problems/random_fields.h"

namespace isoline::problems {
namespace {

struct Options {
  Index N = 8;
  Learning learning{.network = "mlp[layers=64-128-64,activation=tanh,precision=double,init=glorot]",
                    .batch = 64};
};
void fields(Options& o, auto& field) {
  field("N", o.N, between(2, 1024), "cells along each side");
  fields(o.learning, field);
}

class PoissonHig final : public SelfAdjointPhysics {
 public:
  explicit PoissonHig(Index N) : laplacian_(N) {}
  Index inputs() const override { return laplacian_.cells(); }
  Index outputs() const override { return laplacian_.cells(); }
  void apply(BatchRef x, BatchOut y) const override { laplacian_.apply(x, y); }
  // The same of each sample.
  void jacobian(BatchOut J, Workspace& w) const override {
    const Index k = inputs();
    w.unit.setIdentity(k, k);
    laplacian_.apply(w.unit, J.leftCols(k));
    for (Index first = k; first < J.cols(); first += k) J.middleCols(first, k) = J.leftCols(k);
  }

  Inverse inverse_kind() const override { return Inverse::exact; }
  Success local_inverse(BatchRef y, BatchRef, BatchRef, BatchOut x) const override {
    laplacian_.solve(y, x);
    return Success::Constant(y.cols(), true);
  }

 private:
  Laplacian laplacian_;
};

// The scale of the noise is a factor that the normalization removes, except for the smallest wave
// number that passes, and at a scale of N there is no such limit.
Vector noise(Index N, RandomStream& stream) {
  return smooth_noise(N, static_cast<Real>(N), 1, stream);
}

Field field_of(Index N) {
  return {.rows = N, .columns = N, .x = {"potential"}, .y = {"∇²x", "1/cell²"}};
}

ProblemParts learn_poisson_hig(const Options& o, const Draw& draw) {
  const auto sample = sample_of(std::make_shared<const PoissonHig>(o.N),
                                [N = o.N](RandomStream& stream) { return noise(N, stream); });
  const Index cells = o.N * o.N;
  ProblemParts parts = learn(o.learning, {.inputs = cells, .outputs = cells, .grid = o.N}, draw,
                             {.physics = std::make_unique<PoissonHig>(o.N),
                              .x_error = summed_error,
                              .samples = {.validation = 64, .draw = sample},
                              .field = field_of(o.N)});
  const Network& network = *parts.network;
  parts.series = joined(std::move(parts.series),
                        joined(hidden_activity(network), saturation(network, /*shown=*/0)));
  return parts;
}

ProblemParts make_poisson_hig(const Options& o, const Draw& draw) {
  if (o.learning.is_on()) return learn_poisson_hig(o, draw);
  RandomStream stream = draw.stream("target");
  return from_exact_data(std::make_unique<PoissonHig>(o.N), noise(o.N, stream), field_of(o.N),
                         draw);
}

}  // namespace

void register_poisson_hig(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "poisson-hig",
       .title = "Poisson equation, judged by its right-hand side",
       .group = Group::physics,
       .formula = "P(x) = ∇²x,  L = ½‖P(x) − y*‖²",
       .source = "Schnell, Holl, Thuerey (2022), published scripts",
       .note = "Published as a learning problem, with the loss summed over the batch; here it is "
               "the mean, so that η = 0.64 here equals η = 0.01 there at B = 64. The problem "
               "`poisson` has the inverse physics, P = ∇⁻². P is linear and inverted exactly, so "
               "SIP's target is x* itself.",
       .aim = Aim::loss,  // what the published curve shows
       .in_all = false,
       .panels = {{.title = "Learning curves", .kind = "curve"},
                  {.title = "Saturated neurons", .kind = "series", .quantity = "saturated neurons"},
                  {.title = "One sample of the validation", .kind = "pictures"}}},
      make_poisson_hig));
}

}  // namespace isoline::problems
