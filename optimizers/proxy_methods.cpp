// Methods that find an x̃ for every sample and draw the network to it: one step of a gradient rule
// on the proxy loss (1/B) Σ ½‖x − x̃‖², or (1/B) Σ |x − x̃|, with x̃ held. With the identity network
// and gd[rate=1] it is x ← x̃. All are of Holl, Koltun, Thuerey (2022).
//
// sip: scale-invariant physics training, Fig. 3: pull the target back through the physics by its
// local inverse, x̃ = P⁻¹(y + Δy; x) with Δy = η (y* − y). With the identity network and unit rates
// it is the inverse-simulator update. Several steps of the inversion may be taken for one of the
// network, each from the x̃ of the last, and several of the network for one x̃. With count=raised a
// series has the share of points nearer to x̃ than x is at which L is greater than at x: Fig. 4 has
// it below half, the less the more dimensions x has.
//
// sip-theorem-3: as many as theorem 3 requires for convergence: with U = x̃ − x and L(x + U) =
// (1 − τ) L(x) the network takes steps toward x̃, held, until
//
//   L(N(θ)) ≤ (1 − τ/2) L(x),
//
// half of what U itself gives, and only then is the physics inverted again. At most `most-steps`,
// for a network need not be able to: the share of the U so far that it could not follow is traced.
// So is the bound K of the theorem's second condition (equation 12), ‖U‖ ≤ K (L − L*) with L* = 0,
// of lengths as root mean squares over the samples. Near a solution L falls with the square of ‖U‖,
// and no K holds. Deviation: all samples of a fresh batch are stopped together, by their mean loss.
//
// sip-newton: by Newton's step in x, sample by sample, as the published script for Fig. 2 has it
// besides its curves: x̃ = x − sign(g) |g/h| with g and h the first and second derivative of
// ½‖P(x) − y*‖², plain; with |x̃ − x| at most 0.1, clipped; or with 0.01 added to h, damped. For
// several inputs g and h are taken along the Hessian's eigenvectors.
//
// rescaled: gradients rescaled to unit length in x, Fig. 2: x̃ = x − d/‖d‖, d = ∂L/∂x, sample by
// sample. The published script has one x and takes its sign from the known solution,
// x̃ = x + sign(x* − x), which for a monotone P is the same.
//
// supervised: x̃ = x*, the input that produced y*. The physics is used only for the data. Where
// several x give the same y* it learns their mean, which solves nothing.
//
// two-stage: a solver finds a label x̃ = P⁻¹(y*; x₀) for every y*, then the network learns the
// labels alone. The solver starts at the same x₀ for all, or at what the untrained network says.
// Where several x give the same y*, neighbouring y* may get labels of different branches, and the
// network what lies between.
#include <cmath>

#include "optimizers/inversion.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

constexpr const char* kAutomatic = "auto";

// The rule that the option network-optimizer stands for, of an identity network or another.
std::string rule_of(const std::string& option, bool has_identity_network) {
  if (option != kAutomatic) return option;
  return has_identity_network ? "gd[rate=1]" : "adam[rate=1e-3]";
}

struct ProxyOptions {
  std::string network_optimizer = kAutomatic;
};
void rule_field(ProxyOptions& o, auto& field) {
  field("network-optimizer", o.network_optimizer, Choices{},
        "gradient rule on the proxy loss; auto: gd[rate=1] for the identity network, else "
        "adam[rate=1e-3]");
}

enum class Proxy { l2, l1 };

// A method made of Options, of which the step in θ is the network's own.
template <class Options>
class ProxyMethod : public Optimizer {
 public:
  ProxyMethod(const Options& options, const OptimizerRegistry& registry)
      : options_(options), registry_(registry) {
    if (options.network_optimizer != kAutomatic)
      rule_ = make_descent(registry, options.network_optimizer);
  }
  void start(Meter& f, const Vector&) override {
    if (options_.network_optimizer == kAutomatic)
      rule_ = make_descent(registry_, rule_of(kAutomatic, f.has_identity_network()));
    rule_->start(f.unknowns());
    gradient_.resize(f.unknowns());
    if constexpr (requires { options_.inversion; })
      inversion_ = make_inversion(options_.inversion, f.inverse_kind());
  }
  bool persist(Archive& archive) override { return rule_->persist(archive); }

 protected:
  void approach(const Matrix& found, Linearization& at, Vector& theta, Proxy proxy = Proxy::l2) {
    pull_ = at.x() - found;
    if (proxy == Proxy::l1) pull_ = pull_.cwiseSign();
    pull_ /= static_cast<Real>(pull_.cols());
    at.network_pullback(pull_, gradient_);
    rule_->update(gradient_, theta);
  }
  // So many steps of the inversion from `at`, each after the first from the last x̃; how many
  // samples were moved along the gradient.
  Index invert(Meter& f, Linearization& at, Index steps, Matrix& found) {
    Index moved = inversion_->invert(f, at, found);
    for (Index i = 1; i < steps && !f.is_spent(); ++i) {
      f.linearize_physics(found, inner_);
      moved += inversion_->invert(f, inner_, found);
    }
    return moved;
  }

  const Options options_;
  std::unique_ptr<Inversion> inversion_;
  Linearization at_, inner_;
  Matrix found_;  // (k, B) x̃

 private:
  const OptimizerRegistry& registry_;
  std::unique_ptr<Descent> rule_;
  Matrix pull_;      // (k, B), the proxy's gradient in x
  Vector gradient_;  // (n)
};

template <class Method, class Options>
OptimizerEntry proxy_entry(OptimizerEntry entry) {
  entry.family = Family::inversion;
  entry.kind = Kind::inversion;
  entry.options = option_table<Options>();
  entry.inside = [](const OptionValues& options, bool is_learning) -> std::vector<std::string> {
    return {rule_of(options.text("network-optimizer"), !is_learning)};
  };
  if constexpr (requires(Options o) { o.inversion; }) {
    entry.needs_for = [](const OptionValues& options, const Problem& problem) {
      return needs_of(read_options<Options>(options).inversion, problem);
    };
    entry.objection = [also = entry.objection](const OptionValues& options,
                                               const Problem& problem) -> std::string {
      if (std::string own = also ? also(options, problem) : ""; !own.empty()) return own;
      return objection_to(read_options<Options>(options).inversion, problem);
    };
  }
  entry.make = [](const OptionValues& options,
                  const OptimizerRegistry& known) -> std::unique_ptr<Optimizer> {
    return std::make_unique<Method>(read_options<Options>(options), known);
  };
  return entry;
}

struct SipOptions : ProxyOptions {
  InversionOptions inversion;
  std::string proxy = "l2", count;
  Index inner_steps = 1, network_steps = 1;

  bool falls_back() const { return inversion.fallback == "gradient"; }
};
void fields(SipOptions& o, auto& field) {
  fields(o.inversion, field);
  rule_field(o, field);
  field("proxy", o.proxy, Choices{"l2", "l1"}, "proxy loss: ½‖x − x̃‖² or Σ|x − x̃|");
  field("inner-steps", o.inner_steps, between(1, 1e6), "steps of the inversion per update");
  field("fallback", o.inversion.fallback, Choices{"none", "gradient"},
        "if the problem's own inverse fails for a sample: the sample keeps its x; or it moves as "
        "with inverse=gradient, and a series of the record counts it");
  field("network-steps", o.network_steps, between(1, 1e6), "steps of the network toward each x̃");
  field("count", o.count, Choices{"", "raised"},
        "raised: a series of the record has the share that raise L, of points nearer to x̃ than x");
}

class Sip final : public ProxyMethod<SipOptions> {
 public:
  using ProxyMethod::ProxyMethod;
  void start(Meter& f, const Vector& theta) override {
    ProxyMethod::start(f, theta);
    std::vector<std::string> names;
    if (options_.falls_back()) names.push_back("samples moved along the gradient");
    if (!options_.count.empty()) names.push_back("share that raises L");
    if (!names.empty()) f.name_series(names);
  }
  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    fallbacks_ += invert(f, at_, options_.inner_steps, found_);
    if (options_.falls_back()) f.note(0, static_cast<Real>(fallbacks_));
    if (!options_.count.empty()) f.note(options_.falls_back() ? 1 : 0, raised_share(f));
    const Proxy proxy = options_.proxy == "l1" ? Proxy::l1 : Proxy::l2;
    approach(found_, at_, theta, proxy);
    for (Index i = 1; i < options_.network_steps && !f.is_spent(); ++i) {
      f.linearize(theta, at_);
      approach(found_, at_, theta, proxy);
    }
    return Status::running;
  }
  bool persist(Archive& archive) override {
    archive(fallbacks_);
    return ProxyMethod::persist(archive);
  }

 private:
  // The same points of the unit ball in every step.
  Real raised_share(Meter& f) {
    constexpr int kPoints = 4000;
    RandomStream stream(0, "sip", "ball");
    const Index k = found_.rows();
    int raised = 0;
    for (int i = 0; i < kPoints; ++i) {
      nearer_ = found_;
      for (Index b = 0; b < found_.cols(); ++b) {
        const Real share = std::pow(stream.uniform(), 1 / static_cast<Real>(k));
        nearer_.col(b) +=
            share * (found_ - at_.x()).col(b).norm() * stream.normal_vector(k).normalized();
      }
      f.linearize_physics(nearer_, inner_);
      if (inner_.loss() > at_.loss()) ++raised;
    }
    return static_cast<Real>(raised) / kPoints;
  }

  Index fallbacks_ = 0;  // samples so far
  Matrix nearer_;        // (k, B)
};

struct Theorem3Options : ProxyOptions {
  InversionOptions inversion;
  Index most_steps = 100;
};
void fields(Theorem3Options& o, auto& field) {
  fields(o.inversion, field);
  rule_field(o, field);
  field("most-steps", o.most_steps, between(1, 1e6), "steps of the network toward each x̃, at most");
}

class SipTheorem3 final : public ProxyMethod<Theorem3Options> {
 public:
  using ProxyMethod::ProxyMethod;
  void start(Meter& f, const Vector& theta) override {
    ProxyMethod::start(f, theta);
    f.name_series(
        {"τ of U", "K of U", "length of U", "network steps of U", "U not followed, share"});
  }
  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    inversion_->invert(f, at_, found_);
    f.linearize_physics(found_, inner_);
    const Real tau = 1 - inner_.loss() / at_.loss();
    const Real goal = (1 - tau / 2) * at_.loss();
    const Real length = (found_ - at_.x()).norm() / std::sqrt(static_cast<Real>(found_.cols()));
    f.note(0, tau);
    f.note(1, length / at_.loss());
    f.note(2, length);
    Index steps = 0;
    do {
      approach(found_, at_, theta);
      f.linearize(theta, at_);
    } while (++steps < options_.most_steps && at_.loss() > goal && !f.is_spent());
    ++updates_;
    if (at_.loss() > goal) ++not_followed_;
    f.note(3, static_cast<Real>(steps));
    f.note(4, static_cast<Real>(not_followed_) / static_cast<Real>(updates_));
    return Status::running;
  }
  bool persist(Archive& archive) override {
    archive(updates_, not_followed_);
    return ProxyMethod::persist(archive);
  }

 private:
  std::int64_t updates_ = 0, not_followed_ = 0;
};

struct NewtonOptions : ProxyOptions {
  Real clip = 0, damping = 0;
};
void fields(NewtonOptions& o, auto& field) {
  field("clip", o.clip, at_least(0), "longest step along an eigenvector; 0: no limit");
  field("damping", o.damping, at_least(0), "what is added to each eigenvalue");
  rule_field(o, field);
}

class SipNewton final : public ProxyMethod<NewtonOptions> {
 public:
  SipNewton(const NewtonOptions& options, const OptimizerRegistry& registry)
      : ProxyMethod(options, registry) {
    inversion_ = inversion_by_plain_newton(options.clip, options.damping);
  }
  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    inversion_->invert(f, at_, found_);
    approach(found_, at_, theta);
    return Status::running;
  }
};

struct RescaledOptions : ProxyOptions {
  std::string by = "gradient";
};
void fields(RescaledOptions& o, auto& field) {
  field("by", o.by, Choices{"gradient", "truth"},
        "where the direction comes from: −∂L/∂x, or x* − x (extra information)");
  rule_field(o, field);
}

class Rescaled final : public ProxyMethod<RescaledOptions> {
 public:
  using ProxyMethod::ProxyMethod;
  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    if (options_.by == "truth") {
      slope_ = at_.x() - f.truth();
    } else {
      at_.cotangent(g_);
      slope_.resizeLike(at_.x());
      at_.physics_pullback(g_, slope_);
    }
    found_ = at_.x();
    for (Index b = 0; b < found_.cols(); ++b) {
      const Real largest = slope_.col(b).cwiseAbs().maxCoeff();
      if (largest == 0) continue;
      slope_.col(b) /= largest;  // squares of 1e-200 would vanish
      found_.col(b) -= slope_.col(b) / slope_.col(b).norm();
    }
    approach(found_, at_, theta);
    return Status::running;
  }

 private:
  Matrix g_, slope_;  // (m, B), (k, B) ∂L/∂x
};

OracleSet needs_of_rescaled(const OptionValues& options, const Problem&) {
  return {Oracle::forward, Oracle::network,
          options.text("by") == "truth" ? Oracle::truth : Oracle::pullback};
}

struct SupervisedOptions : ProxyOptions {};
void fields(SupervisedOptions& o, auto& field) { rule_field(o, field); }

class Supervised final : public ProxyMethod<SupervisedOptions> {
 public:
  using ProxyMethod::ProxyMethod;
  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    approach(f.truth(), at_, theta);
    return Status::running;
  }
};

struct TwoStageOptions : ProxyOptions {
  InversionOptions inversion;
  std::string from = "zero";
  Index solver_steps = 1;
};
void fields(TwoStageOptions& o, auto& field) {
  fields(o.inversion, field);
  field("from", o.from, Choices{"zero", "network"},
        "where the solver starts: x₀ = 0, or the untrained network's x");
  field("solver-steps", o.solver_steps, between(1, 1e6), "steps of the solver for each label");
  rule_field(o, field);
}

class TwoStage final : public ProxyMethod<TwoStageOptions> {
 public:
  using ProxyMethod::ProxyMethod;
  void start(Meter& f, const Vector& theta) override {
    ProxyMethod::start(f, theta);
    untrained_ = theta;
  }
  // The labels of fixed samples are found once.
  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    if (f.has_fresh_batches() || found_.size() == 0) label(f);
    approach(found_, at_, theta);
    return Status::running;
  }
  bool persist(Archive& archive) override {
    archive(untrained_, found_);
    return ProxyMethod::persist(archive);
  }

 private:
  void label(Meter& f) {
    if (options_.from == "zero")
      f.linearize_physics(Matrix::Zero(at_.x().rows(), at_.x().cols()), solver_);
    else
      f.linearize(untrained_, solver_);
    invert(f, solver_, options_.solver_steps, found_);
  }

  Linearization solver_;
  Vector untrained_;  // (n) θ₀
};

// Without a network the first step would be the answer itself, or the solver alone.
auto objection_without_network(const char* words) {
  return [words](const OptionValues&, const Problem& problem) -> std::string {
    return problem.has_identity_network() ? words : "";
  };
}

}  // namespace

void register_proxy_methods(OptimizerRegistry& registry) {
  registry.add(proxy_entry<Sip, SipOptions>(
      {.name = "sip",
       .title = "Scale-invariant physics",
       .formula = "x̃ = P⁻¹(y + η (y* − y); x);  θ ← one step on (1/B) Σ ½‖x − x̃‖²",
       .source = "Holl, Koltun, Thuerey (2022), Fig. 3",
       .note = "The inverse is the problem's own, a saddle-free Newton step with exact second "
               "derivatives, or found by L-BFGS; if it is damped or an estimate, x̃ = x + "
               "η (P⁻¹(y*; x) − x), and for Newton x + η U. The problem's own inverse and its "
               "second derivatives are extra information; L-BFGS is not.",
       .needs = {Oracle::forward, Oracle::network},
       .is_input_scale_invariant = true,
       .tunable = {.option = "step", .below = 5}}));
  registry.add(proxy_entry<SipTheorem3, Theorem3Options>(
      {.name = "sip-theorem-3",
       .title = "Scale-invariant physics, stopped by theorem 3",
       .formula = "x̃ = x + U;  θ ← steps on (1/B) Σ ½‖x − x̃‖² until L ≤ (1 − τ/2) L(x),  "
                  "τ = 1 − L(x + U)/L(x)",
       .source = "Holl, Koltun, Thuerey (2022), theorem 3",
       .note = "All samples of a batch are stopped together. Records contain τ, K = ‖U‖/(L − L*), "
               "the length of U as a root mean square over the samples, the network's steps, and "
               "the share of all U so far that these steps did not achieve. Each check of the "
               "loss counts as a forward solve.",
       .needs = {Oracle::forward, Oracle::network},
       .is_input_scale_invariant = true,
       .tunable = {.option = "step", .below = 5},
       .in_all = false}));
  registry.add(proxy_entry<SipNewton, NewtonOptions>(
      {.name = "sip-newton",
       .title = "Network trained by Newton's step in x",
       .formula = "x̃ = x − sign(g) |g/h|,  g = ∂L/∂x, h = ∂²L/∂x²;  "
                  "θ ← one step on (1/B) Σ ½‖x − x̃‖²",
       .source = "Holl, Koltun, Thuerey (2022), published script: train_exp.py",
       .note = "The script's variants are clip=0.1 and damping=0.01; none is in a figure.",
       .needs = {Oracle::forward, Oracle::network, Oracle::sensitivity, Oracle::curvature},
       .is_input_scale_invariant = true,
       .tunable = {.option = "network-optimizer"},
       .in_all = false,
       .objection = [](const OptionValues&, const Problem& problem) {
         return objection_to_newton(problem, "Newton's step in x");
       }}));
  registry.add(proxy_entry<Rescaled, RescaledOptions>(
      {.name = "rescaled",
       .title = "Rescaled gradients",
       .formula = "x̃ = x − d/‖d‖,  d = ∂L/∂x;  θ ← one step on (1/B) Σ ½‖x − x̃‖²",
       .source = "Holl, Koltun, Thuerey (2022), Fig. 2",
       .note = "by=truth uses d = x − x*, as in the published script.",
       .needs = {Oracle::forward, Oracle::network},
       .tunable = {.option = "network-optimizer", .below = 6},
       .needs_for = needs_of_rescaled}));
  registry.add(proxy_entry<Supervised, SupervisedOptions>(
      {.name = "supervised",
       .title = "Supervised training",
       .formula = "θ ← one step on (1/B) Σ ½‖x − x*‖²",
       .source = "Holl, Koltun, Thuerey (2022)",
       .note = "Uses the x* that produced each y*. If the inverse has several branches, it "
               "learns their mean. The forward pass counts completely, including the physics.",
       .needs = {Oracle::forward, Oracle::network, Oracle::truth},
       .is_input_scale_invariant = true,
       .tunable = {.option = "network-optimizer"},
       .objection = objection_without_network("it uses x*, and there is no network to learn it")}));
  registry.add(proxy_entry<TwoStage, TwoStageOptions>(
      {.name = "two-stage",
       .title = "Two-stage supervised training",
       .formula = "x̃ = P⁻¹(y*; x₀);  θ ← one step on (1/B) Σ ½‖x − x̃‖²",
       .source = "Holl, Koltun, Thuerey (2022)",
       .note =
           "A solver computes the labels from a fixed x₀. Unlike `supervised`, this method does "
           "not use the x* that produced y*. The solver is one of those of sip, and its work "
           "counts.",
       .needs = {Oracle::forward, Oracle::network},
       .is_input_scale_invariant = true,
       .tunable = {.option = "network-optimizer"},
       .in_all = false,
       .objection = objection_without_network(
           "it labels samples for a network to learn, and there is no network")}));
}

}  // namespace isoline::optimizers
