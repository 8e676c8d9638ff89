// Optimizers and problems that misbehave, each in its own way after two good steps.
#pragma once

#include <csignal>
#include <cstdlib>

#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {

using optimizers::Linearization;
using optimizers::Meter;
using optimizers::stepper_entry;
using problems::Draw;
using problems::problem_entry;
using problems::ProblemParts;

// Descends twice, then does `misdeed`.
struct Hostile {
  std::string misdeed = "throw";

  struct State {
    Linearization at;
    Vector gradient;
    int steps = 0;
    std::vector<std::unique_ptr<char[]>> hoard;
  };
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    constexpr int kGoodSteps = 2;
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    theta -= 1e-3 * s.gradient;
    if (++s.steps > kGoodSteps) misbehave(f, theta, s);
    return Status::running;
  }

 private:
  void misbehave(Meter& f, Vector& theta, State& s) const {
    if (misdeed == "throw") throw std::runtime_error("thrown on purpose");
    if (misdeed == "throw-int") throw 7;
    if (misdeed == "segfault") std::raise(SIGSEGV);
    if (misdeed == "abort") std::abort();
    if (misdeed == "exit") std::_Exit(0);
    if (misdeed == "nan") theta.setConstant(std::nan(""));
    if (misdeed == "overask") s.at.jacobian();
    if (misdeed == "spin")
      for (volatile bool go_on = true; go_on;) {
      }
    if (misdeed == "hoard")
      for (;;) {
        constexpr std::size_t kPiece = std::size_t{64} << 20;
        s.hoard.push_back(std::make_unique<char[]>(kPiece));  // value-initialized: really touched
      }
    static_cast<void>(f);
  }
};

inline void fields(Hostile& o, auto& field) {
  field(
      "misdeed", o.misdeed,
      Choices{"throw", "throw-int", "segfault", "abort", "exit", "nan", "overask", "spin", "hoard"},
      "what it does after two good steps");
}

// A problem that cannot be made: "hang" or "segfault".
struct BrokenOptions {
  std::string misdeed = "hang";
};
inline void fields(BrokenOptions& o, auto& field) {
  field("misdeed", o.misdeed, Choices{"hang", "segfault"}, "what its making does");
}
inline ProblemParts make_broken(const BrokenOptions& o, const Draw&) {
  if (o.misdeed == "segfault") std::raise(SIGSEGV);
  for (volatile bool go_on = true; go_on;) {
  }
  return {};
}

inline Catalog hostile_catalog() {
  Catalog catalog = builtin_catalog();
  catalog.optimizers.add(stepper_entry<Hostile>({.name = "hostile",
                                                 .title = "Misbehaves",
                                                 .formula = "none",
                                                 .source = "here",
                                                 .needs = {Oracle::forward, Oracle::pullback}}));
  catalog.problems.add(problem_entry(
      {.name = "broken", .title = "Cannot be made", .formula = "none", .source = "here"},
      make_broken));
  return catalog;
}

inline Request request_for(const Catalog& catalog, const std::string& problem,
                           const OptionValues& problem_options, const std::string& optimizer,
                           const OptionValues& options) {
  return named({.problem = complete_problem(catalog, problem, problem_options),
                .optimizer = complete_optimizer(catalog, optimizer, options),
                .budget = {.iterations = 50}});
}

}  // namespace isoline::benchmarks
