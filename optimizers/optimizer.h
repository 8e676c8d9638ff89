// An optimizer is a const description of a method, with a State that its step() advances. The
// harness owns the loop, the clock, the stopping tests and the evaluation of success.
#pragma once

#include <concepts>
#include <functional>
#include <memory>

#include "core/options.h"
#include "optimizers/meter.h"
#include "optimizers/optimizer_entry.h"

namespace isoline::optimizers {

// The methods written here: fields are options, State is all that changes.
template <class M>
concept Stepper = requires(const M method, Meter& f, Vector& theta, typename M::State state) {
  { method.init(f, theta) } -> std::same_as<typename M::State>;
  { method.step(f, theta, state) } -> std::same_as<Status>;  // running unless it must stop
};

// A method that turns a gradient into a step and needs nothing else; other methods can use it
// inside.
template <class M>
concept GradientRule = requires(const M rule, VectorRef g, Vector& theta, typename M::State state) {
  { rule.init(Index{}) } -> std::same_as<typename M::State>;
  { rule.update(g, theta, state) } -> std::same_as<void>;
};

// The state of the harness's loop.
class Optimizer {
 public:
  virtual ~Optimizer() = default;
  virtual void start(Meter& f, const Vector& theta) = 0;
  virtual Status step(Meter& f, Vector& theta) = 0;          // one iteration, or the whole solve
  virtual bool reports_iterations() const { return false; }  // to the meter, by itself
  // Its state between two steps, so that another process can go on; false where it has no way to.
  virtual bool persist(Archive&) { return false; }
};

// A gradient rule with its state, for the methods that use one inside.
class Descent {
 public:
  virtual ~Descent() = default;
  virtual void start(Index n) = 0;
  virtual void update(VectorRef g, Vector& theta) = 0;
  virtual bool persist(Archive&) { return false; }
};

// A method or rule whose State is more than scratch arrays lists the members that survive a step:
//
//   static void persist(State& s, Archive& archive) { archive(s.m, s.v); }
template <class M>
bool persist_state(typename M::State& state, Archive& archive) {
  if constexpr (requires { M::persist(state, archive); }) {
    M::persist(state, archive);
    return true;
  }
  return std::is_empty_v<typename M::State>;
}

// The oracles that this optimizer needs for this problem: the meter grants these.
OracleSet needs_of(const OptimizerEntry& entry, const OptionValues& options,
                   const Problem& problem);

// The extra information of a method with these oracles, in words.
std::vector<std::string> privileges_of(OracleSet granted, Inverse inverse);

// Why this optimizer cannot treat this problem, in words; empty if it can.
std::string why_inapplicable(const OptimizerEntry& entry, const OptionValues& options,
                             const Problem& problem);

// Whether a method of least squares that has the choice uses a sparse J.
bool is_solved_sparse(const Problem& problem);

// A gradient rule from "adam[rate=1e-3]".
std::unique_ptr<Descent> make_descent(const OptimizerRegistry& registry, const std::string& spec);

// --- adaptors from the concepts to what the harness holds

template <Stepper M>
class Stepping final : public Optimizer {
 public:
  explicit Stepping(M method) : method_(std::move(method)) {}
  void start(Meter& f, const Vector& theta) override { state_ = method_.init(f, theta); }
  Status step(Meter& f, Vector& theta) override { return method_.step(f, theta, state_); }
  bool persist(Archive& archive) override { return persist_state<M>(state_, archive); }

 private:
  const M method_;
  typename M::State state_{};
};

// A gradient rule on its own.
class ByGradient final : public Optimizer {
 public:
  explicit ByGradient(std::unique_ptr<Descent> rule, bool keeps_bounds = false)
      : rule_(std::move(rule)), keeps_bounds_(keeps_bounds) {}
  void start(Meter& f, const Vector&) override { rule_->start(f.unknowns()); }
  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    at_.gradient(gradient_);
    rule_->update(gradient_, theta);
    if (const Bounds* bounds = f.bounds(); bounds && keeps_bounds_) theta = bounds->nearest(theta);
    return Status::running;
  }
  bool persist(Archive& archive) override { return rule_->persist(archive); }

 private:
  std::unique_ptr<Descent> rule_;
  bool keeps_bounds_;
  Linearization at_;
  Vector gradient_;  // (n)
};

template <GradientRule R>
class Descending final : public Descent {
 public:
  explicit Descending(const R& rule) : rule_(rule) {}
  void start(Index n) override { state_ = rule_.init(n); }
  void update(VectorRef g, Vector& theta) override { rule_.update(g, theta, state_); }
  bool persist(Archive& archive) override { return persist_state<R>(state_, archive); }

 private:
  const R rule_;
  typename R::State state_{};
};

// An entry for a method that is a Stepper: its struct is its options.
template <Stepper M>
OptimizerEntry stepper_entry(OptimizerEntry entry) {
  entry.options = option_table<M>();
  entry.make = [](const OptionValues& options,
                  const OptimizerRegistry&) -> std::unique_ptr<Optimizer> {
    return std::make_unique<Stepping<M>>(read_options<M>(options));
  };
  return entry;
}

// An entry for a method that is a gradient rule.
template <GradientRule R>
OptimizerEntry rule_entry(OptimizerEntry entry) {
  entry.options = option_table<R>();
  entry.needs = {Oracle::forward, Oracle::pullback};
  entry.make_descent = [](const OptionValues& options) -> std::unique_ptr<Descent> {
    return std::make_unique<Descending<R>>(read_options<R>(options));
  };
  entry.make = [rule = entry.make_descent, keeps_bounds = entry.keeps_bounds](
                   const OptionValues& options, const OptimizerRegistry&) {
    return std::make_unique<ByGradient>(rule(options), keeps_bounds);
  };
  return entry;
}

}  // namespace isoline::optimizers
