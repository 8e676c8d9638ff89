// Requests made anew.
#include "benchmarks/run/again.h"

#include <fmt/format.h>

#include "core/errors.h"

namespace isoline::benchmarks {

Request request_again(const Catalog& catalog, const Record& record, double hard_seconds) {
  Request request = record.request;
  const Component &problem = record.request.problem, &optimizer = record.request.optimizer;
  request.problem = complete_problem(catalog, problem.name, problem.options);
  request.optimizer = complete_optimizer(catalog, optimizer.name, optimizer.options);
  request.problem.asked = problem.asked;
  request.optimizer.asked = optimizer.asked;
  request.hard_seconds = hard_seconds;
  return named(std::move(request));
}

}  // namespace isoline::benchmarks
