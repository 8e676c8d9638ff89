// P = ∇⁻²: y solves ∇²y = x on N×N cells of width 1, with the five-point Laplacian and a value 0
// one width beyond the first and last cell. Holl, Koltun, Thuerey (2022), Fig. 6a, as a direct
// problem. The authors solve by conjugate gradients to 1e-5; the sine transform is exact.
#include "problems/exact_data.h"
#include "problems/laplacian.h"
#include "problems/learning.h"
#include "problems/random_fields.h"

namespace isoline::problems {
namespace {

struct Options {
  Index N = 64;
  Learning learning{.network = "unet", .batch = 128};
};
void fields(Options& o, auto& field) {
  field("N", o.N, between(2, 1024), "cells along each side");
  fields(o.learning, field);
}

class Poisson final : public SelfAdjointPhysics {
 public:
  explicit Poisson(Index N) : laplacian_(N) {}
  Index inputs() const override { return laplacian_.cells(); }
  Index outputs() const override { return laplacian_.cells(); }
  void apply(BatchRef x, BatchOut y) const override { laplacian_.solve(x, y); }

  Inverse inverse_kind() const override { return Inverse::exact; }
  Success local_inverse(BatchRef y, BatchRef, BatchRef, BatchOut x) const override {
    laplacian_.apply(y, x);
    return Success::Constant(y.cols(), true);
  }

 private:
  Laplacian laplacian_;
};

Field field_of(Index N) {
  return {.rows = N, .columns = N, .x = {"source ∇²y", "1/cell²"}, .y = {"potential"}};
}

ProblemParts learn_poisson(const Options& o, const Draw& draw) {
  const auto sample = sample_of(std::make_shared<const Poisson>(o.N),
                                [N = o.N](RandomStream& s) { return smooth_noise(N, 10, 1, s); });
  return learn(o.learning, {.inputs = o.N * o.N, .outputs = o.N * o.N, .grid = o.N}, draw,
               {.physics = std::make_unique<Poisson>(o.N),
                .x_error = summed_error,
                .samples = {.validation = 64, .draw = sample},
                .field = field_of(o.N)});
}

ProblemParts make_poisson(const Options& o, const Draw& draw) {
  if (o.learning.is_on()) return learn_poisson(o, draw);
  RandomStream stream = draw.stream("target");
  return from_exact_data(std::make_unique<Poisson>(o.N), smooth_noise(o.N, 10, 1, stream),
                         field_of(o.N), draw);
}

}  // namespace

void register_poisson(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "poisson",
       .title = "Poisson equation",
       .group = Group::physics,
       .formula = "P(x) = ∇⁻²x,  L = ½‖P(x) − y*‖²",
       .source = "Holl, Koltun, Thuerey (2022), Fig. 6a",
       .note =
           "x* is smooth noise from our own random streams, for seed 0, too: no instance is "
           "published. The standard start is 0. Published curves sum |x − x*| over cells, and "
           "so does mode=learn; the error of one instance is ‖x − x*‖. P is linear and inverted "
           "exactly, so SIP's target is x* itself: here SIP equals supervised "
           "training on exact labels.",
       .aim = Aim::x,  // P is one to one
       .panels = {{.title = "Fig. 6b: learning curves", .kind = "curve"},
                  {.title = "Fig. 6a: one sample of the validation", .kind = "pictures"}}},
      make_poisson));
}

}  // namespace isoline::problems
