// Rounds: calls that several workers can make at once.
#include "optimizers/ledger.h"

#include <algorithm>

namespace isoline::optimizers {

void Ledger::exhaust() {
  close();
  throw BudgetSpent();
}

const Matrix& Ledger::announce(const Matrix& thetas, std::int64_t paid) {
  const std::int64_t affordable = (most_ - work_) / price(Oracle::forward) + paid;
  announced_ = thetas.leftCols(std::clamp<std::int64_t>(affordable, 0, thetas.cols()));
  next_announced_ = in_batch_ = 0;
  return announced_;
}

bool Ledger::takes_announced(VectorRef theta) {
  const bool is_next =
      next_announced_ < announced_.cols() && announced_.col(next_announced_) == theta;
  next_announced_ = is_next ? next_announced_ + 1 : announced_.cols();
  return is_next;
}

void Ledger::share_batch() {
  for (std::size_t i = 0; i < kWorkers.size(); ++i)
    if (in_batch_ % kWorkers[i] != 0) ++spared_[i];
  ++in_batch_;
}

void Ledger::share_product(Oracle oracle) {
  const std::int64_t calls = price(oracle);
  for (std::size_t i = 0; are_products_at_once_ && i < kWorkers.size(); ++i)
    spared_[i] += calls - (calls + kWorkers[i] - 1) / kWorkers[i];
}

Rounds Ledger::rounds() const {
  Rounds rounds;
  for (std::size_t i = 0; i < kWorkers.size(); ++i) rounds[i] = work_ - spared_[i];
  return rounds;
}

}  // namespace isoline::optimizers
