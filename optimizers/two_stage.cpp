// Two-stage supervised training, Holl, Koltun, Thuerey (2022): first a solver finds a label
// x̃ = P⁻¹(y*; x₀) for every y*, then the network learns the labels alone, (1/B) Σ ½‖x − x̃‖². The
// solver starts at the same x₀ for all, or at what the untrained network says. Where several x give
// the same y*, neighbouring y* may get labels of different branches, and the network what lies
// between. `supervised` has the generator's own x* for labels.

#include "optimizers/inversion.h"
#include "optimizers/network_descent.h"

namespace isoline::optimizers {
namespace {

struct Options {
  InversionOptions inversion;
  std::string from = "zero", network_optimizer = "auto";
  Index solver_steps = 1;
};

void fields(Options& o, auto& field) {
  fields(o.inversion, field);
  field("from", o.from, Choices{"zero", "network"},
        "where the solver starts: x₀ = 0, or the untrained network's x");
  field("solver-steps", o.solver_steps, between(1, 1e6), "steps of the solver for each label");
  field("network-optimizer", o.network_optimizer, Choices{}, NetworkDescent::kDoc);
}

class TwoStage final : public ProxyMethod {
 public:
  TwoStage(const Options& options, const OptimizerRegistry& registry)
      : ProxyMethod(registry, options.network_optimizer), options_(options) {}

  void start(Meter& f, const Vector& theta) override {
    inversion_ = make_inversion(options_.inversion, f.inverse_kind());
    ProxyMethod::start(f, theta);
    untrained_ = theta;
  }

  // The labels of fixed samples are found once.
  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    if (f.has_fresh_batches() || labels_.size() == 0) label(f);
    descent_.approach(labels_, Proxy::l2, at_, theta);
    return Status::running;
  }

  bool persist(Archive& archive) override {
    archive(untrained_, labels_);
    return descent_.persist(archive);
  }

 private:
  void label(Meter& f) {
    if (options_.from == "zero") {
      f.linearize_physics(Matrix::Zero(at_.x().rows(), at_.x().cols()), solver_);
    } else {
      f.linearize(untrained_, solver_);
    }
    inversion_->invert(f, solver_, labels_);
    for (Index i = 1; i < options_.solver_steps && !f.is_spent(); ++i) {
      f.linearize_physics(labels_, solver_);
      inversion_->invert(f, solver_, labels_);
    }
  }

  const Options options_;
  std::unique_ptr<Inversion> inversion_;
  Linearization solver_;
  Vector untrained_;  // (n) θ₀
  Matrix labels_;     // (k, B) x̃
};

// Without a network it would be the solver alone.
std::string objection(const OptionValues& options, const Problem& problem) {
  if (problem.has_identity_network())
    return "it labels samples for a network to learn, and there is no network";
  return objection_of_inversion<Options>(options, problem);
}

}  // namespace

void register_two_stage(OptimizerRegistry& registry) {
  registry.add(proxy_entry<TwoStage, Options>(
      {.name = "two-stage",
       .title = "Two-stage supervised training",
       .formula = "x̃ = P⁻¹(y*; x₀);  θ ← one step on (1/B) Σ ½‖x − x̃‖²",
       .source = "Holl, Koltun, Thuerey (2022)",
       .note =
           "A solver finds the labels from a fixed x₀; they are not the x* that produced y*, which "
           "`supervised` uses. The solver is one of sip's, and its work counts.",
       .needs = {Oracle::forward, Oracle::network},
       .is_input_scale_invariant = true,
       .tunable = {.option = "network-optimizer"},
       .in_all = false,
       .needs_for = needs_of_inversion<Options>,
       .objection = objection}));
}

}  // namespace isoline::optimizers
