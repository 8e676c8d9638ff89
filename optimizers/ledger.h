// The calls of a run by kind, what they cost, and how much work the budget has left. Calls that can
// be made at once share rounds.
#pragma once

#include <cstdint>

#include "core/archive.h"
#include "core/array.h"
#include "core/oracle.h"
#include "core/trace.h"
#include "problems/problem.h"

namespace isoline::optimizers {

// An oracle throws it if its call would exceed the budget of work: the step is not taken, and the
// run ends with the status `budget`. No library may let it pass.
struct BudgetSpent {};

class Ledger {
 public:
  // One forward of the budget is left for the returned point of a direct problem.
  Ledger(const problems::Problem& problem, std::int64_t budget)
      : prices_(problem.prices()),
        budget_(budget),
        most_(budget - (problem.is_learned() ? 0 : price(Oracle::forward))),
        are_products_at_once_(problem.products().are_at_once) {}

  std::int64_t price(Oracle oracle) const { return prices_[static_cast<std::size_t>(oracle)]; }
  // Calls of the method.
  void charge(Oracle oracle, std::int64_t calls) {
    if (work_ + calls * price(oracle) > most_) exhaust();
    add(oracle, calls);
  }
  // Calls of the harness, which may take what is reserved; false where nothing is left for them.
  bool pay(Oracle oracle, std::int64_t calls) {
    const bool can = has_left(calls * price(oracle));
    if (can) add(oracle, calls);
    return can;
  }
  bool has_left(std::int64_t work) const { return work_ + work <= budget_; }
  // Whether the method has spent its part, or would by so much more.
  bool is_spent(std::int64_t more) const { return is_exhausted_ || work_ + more > most_; }
  void close() { is_exhausted_ = true; }
  [[noreturn]] void exhaust();
  void count_into(auto& point) const {  // of the curve, or where a target was met
    point.counts = counts_;
    point.work = work_;
    point.rounds = rounds();
  }

  // The next forwards are at these columns (n, count), as far as the budget goes; `paid`: that many
  // of them are paid for.
  const Matrix& announce(const Matrix& thetas, std::int64_t paid);
  bool takes_announced(VectorRef theta);  // whether θ is the next of them, and then goes on
  void share_batch();                     // one of them was charged
  void share_product(Oracle oracle);      // one was charged: its forwards may be made at once
  Rounds rounds() const;

  void persist(Archive& archive) { archive(counts_, work_, spared_); }
  bool is_sound() const { return work_ >= 0; }  // what a file brought back need not be

 private:
  void add(Oracle oracle, std::int64_t calls) {
    counts_[static_cast<std::size_t>(oracle)] += calls;
    work_ += calls * price(oracle);
  }

  OracleCounts counts_{}, prices_;
  std::int64_t work_ = 0, budget_, most_;
  bool are_products_at_once_;
  bool is_exhausted_ = false;  // a call would have exceeded the budget
  Rounds spared_{};            // work less rounds
  Matrix announced_;           // (n, count)
  Index next_announced_ = 0;   // column
  std::int64_t in_batch_ = 0;  // calls of the announced ones that were charged
};

}  // namespace isoline::optimizers
