// A method of a shared library, which calls the meter through a table of functions. An exception
// does not cross the library: it is stored, and thrown again when the library has returned.
#include <fmt/format.h>

#include <cmath>
#include <exception>
#include <stdexcept>

#include "core/floating_point.h"
#include "core/foreign/isoline.h"
#include "core/foreign/plugin_library.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

using Eigen::Map;

// The problem, as presented to the library.
struct Questions : isoline_oracles {
  Meter& f;
  const std::string words;  // that name the method
  const bool is_whole_solve;
  bool is_linearized = false;
  Linearization at;
  std::exception_ptr error = nullptr;
  Vector theta, wide;  // (n), (m·B): copies of the library's arrays, aligned like ours
  Matrix narrow;       // (m, B)

  Questions(Meter& meter, const PluginComponent& method);

  // r and J are divided by it: √B.
  Real root() const { return std::sqrt(static_cast<Real>(f.samples())); }
  // Products refer to the current point.
  Linearization& point() {
    require(is_linearized, "call linearize() before any oracle except loss() and report()");
    return at;
  }
  bool is_over() const {
    if (error || f.status() != Status::running) return true;
    return is_whole_solve && f.is_spent();
  }
  const Vector& moved_to(const double* to) {
    theta = Map<const Vector>(to, theta.size());
    require_within_bounds(theta);
    return theta;
  }
  void require_within_bounds(const Vector& to) const {
    for (Index i = 0; lower != nullptr && i < to.size(); ++i)
      require(!(to[i] < lower[i] || to[i] > upper[i]), [&] {
        return fmt::format(
            "{} has ISOLINE_BOUNDS, but component {} of θ is {}, outside its bounds [{}, {}]",
            words, i, to[i], lower[i], upper[i]);
      });
  }
  BatchOut taken(const double* y) {
    const Matrix& like = f.target();
    narrow = Map<const Matrix>(y, like.rows(), like.cols());
    return narrow;
  }
};

// Answers one call; returns 1 if the run is over.
template <class Answer>
int answer(isoline_oracles* asked, const Answer& of) noexcept {
  Questions& all = static_cast<Questions&>(*asked);
  if (all.is_over()) return 1;
  try {
    of(all);
    return 0;
  } catch (const BudgetSpent&) {  // a whole solve ends at its current point; a step is not taken
    if (!all.is_whole_solve) all.error = std::current_exception();
    return 1;
  } catch (...) {
    all.error = std::current_exception();
    return 1;
  }
}

Questions::Questions(Meter& meter, const PluginComponent& method)
    : isoline_oracles{},
      f(meter),
      words(method.words()),
      is_whole_solve(method.can(ISOLINE_SOLVE)),
      theta(meter.unknowns()) {
  if (const Bounds* bounds = f.bounds(); bounds && method.can(ISOLINE_BOUNDS)) {
    lower = bounds->lower.data();
    upper = bounds->upper.data();
  }
  unknowns = static_cast<std::uint64_t>(f.unknowns());
  residuals = static_cast<std::uint64_t>(f.residuals());
  linearize = [](isoline_oracles* asked, const double* to, double* found) {
    return answer(asked, [&](Questions& all) {
      all.f.linearize(all.moved_to(to), all.at);
      all.is_linearized = true;
      *found = all.at.loss();
    });
  };
  loss = [](isoline_oracles* asked, const double* to, double* found) {
    return answer(asked, [&](Questions& all) { *found = all.f.loss(all.moved_to(to)); });
  };
  gradient = [](isoline_oracles* asked, double* g) {
    return answer(asked, [&](Questions& all) {
      all.point().gradient(all.theta);
      Map<Vector>(g, all.theta.size()) = all.theta;
    });
  };
  residual = [](isoline_oracles* asked, double* r) {
    return answer(asked, [&](Questions& all) {
      all.point().residual(all.wide);
      Map<Vector>(r, all.wide.size()) = all.wide;
    });
  };
  pushforward = [](isoline_oracles* asked, const double* v, double* Jv) {
    return answer(asked, [&](Questions& all) {
      all.narrow.resize(all.f.target().rows(), all.f.target().cols());
      all.point().pushforward(all.moved_to(v), all.narrow);
      Map<Vector>(Jv, all.narrow.size()) = all.narrow.reshaped() / all.root();
    });
  };
  pullback = [](isoline_oracles* asked, const double* u, double* JTu) {
    return answer(asked, [&](Questions& all) {
      all.point().pullback(all.taken(u), all.theta);
      Map<Vector>(JTu, all.theta.size()) = all.theta / all.root();
    });
  };
  jacobian = [](isoline_oracles* asked, double* J) {
    return answer(asked, [&](Questions& all) {
      const Matrix& found = all.point().jacobian();
      Map<Matrix>(J, found.rows(), found.cols()) = found / all.root();
    });
  };
  inverse = [](isoline_oracles* asked, const double* y, double* x) {
    return answer(asked, [&](Questions& all) {
      const Success success =
          all.point().local_inverse(all.taken(y), Map<Matrix>(x, all.theta.size(), 1));
      if (!success.all()) Map<Vector>(x, all.theta.size()).setConstant(std::nan(""));
    });
  };
  report = [](isoline_oracles* asked, const double* to) {
    const int told = answer(asked, [&](Questions& all) {
      require(all.is_whole_solve,
              "report() is only for ISOLINE_SOLVE: otherwise, each step() is an iteration");
      all.f.iterate(all.moved_to(to));
    });
    return static_cast<int>(told != 0 || static_cast<Questions&>(*asked).is_over());
  };
}

class PluginMethod final : public Optimizer {
 public:
  PluginMethod(PluginComponent component, OptionValues options)
      : component_(std::move(component)), options_(std::move(options)) {}

  void start(Meter& f, const Vector& theta) override {
    instance_ = std::make_unique<PluginInstance>(component_, options_, 0);
    questions_ = std::make_unique<Questions>(f, component_);
    if (table().start == nullptr) return;
    refresh(f);
    const KeptFloatingPoint around;
    const int told = table().start(instance_->self(), questions_.get(), theta.data());
    throw_what_was_kept();
    if (told != 0) throw std::runtime_error(component_.words() + ": start() failed");
  }

  Status step(Meter& f, Vector& theta) override {
    refresh(f);
    const KeptFloatingPoint around;
    const int told = table().step(instance_->self(), questions_.get(), theta.data());
    throw_what_was_kept();
    questions_->require_within_bounds(theta);
    if (reports_iterations()) {
      if (f.status() != Status::running) return f.status();
      if (f.is_spent()) return Status::budget;
    }
    return status_of(told);
  }

  bool reports_iterations() const override { return component_.can(ISOLINE_SOLVE); }

 private:
  const isoline_component& table() const { return *component_.table; }
  void refresh(Meter& f) { questions_->target = f.target().data(); }  // fresh samples have others
  void throw_what_was_kept() {
    if (questions_->error) std::rethrow_exception(questions_->error);
  }

  Status status_of(int told) const {
    switch (told) {
      case ISOLINE_RUNNING:
        return reports_iterations() ? Status::stalled : Status::running;
      case ISOLINE_CONVERGED:
        return Status::converged;
      case ISOLINE_STALLED:
        return Status::stalled;
      case ISOLINE_FAILED:
        throw std::runtime_error(component_.words() + ": step() failed");
      default:
        throw std::runtime_error(fmt::format(
            "{}: step() must return a value from ISOLINE_RUNNING (0) to ISOLINE_FAILED ({}), got "
            "{}",
            component_.words(), static_cast<int>(ISOLINE_FAILED), told));
    }
  }

  const PluginComponent component_;
  const OptionValues options_;
  std::unique_ptr<PluginInstance> instance_;
  std::unique_ptr<Questions> questions_;
};

OracleSet needs_of(const PluginComponent& component) {
  OracleSet needs{Oracle::forward};
  if (component.can(ISOLINE_PUSHFORWARD)) needs.add(Oracle::pushforward);
  if (component.can(ISOLINE_PULLBACK)) needs.add(Oracle::pullback);
  if (component.can(ISOLINE_JACOBIAN)) needs.add(Oracle::jacobian);
  if (component.can(ISOLINE_INVERSE)) needs.add(Oracle::inverse);
  return needs;
}

}  // namespace

void add_plugin_method(OptimizerRegistry& registry, const PluginComponent& component) {
  OptimizerEntry entry{
      .name = component.name,
      .title = component.title,
      .family = Family::foreign,
      .formula = component.formula,
      .source = component.source,
      .note = component.note,
      .needs = needs_of(component),
      .needs_same_samples = component.can(ISOLINE_COMPARES) || component.can(ISOLINE_SOLVE),
      .keeps_bounds = component.can(ISOLINE_BOUNDS),
      .options = component.options,
      .tunable = {.option = component.tuned}};
  entry.introduce = [foreign = component.foreign](const OptionValues&) { return foreign; };
  entry.objection = [component](const OptionValues&, const Problem& problem) -> std::string {
    const bool fits = !component.can(ISOLINE_INVERSE) || problem.has_identity_network();
    return fits ? "" : "a method of a library inverts the physics and does not support networks";
  };
  entry.make = [component](const OptionValues& options, const OptimizerRegistry&) {
    return std::make_unique<PluginMethod>(component, options);
  };
  registry.add(std::move(entry));
}

}  // namespace isoline::optimizers
