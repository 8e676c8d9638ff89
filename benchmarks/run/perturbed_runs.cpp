// Requests made anew.
#include "benchmarks/run/perturbed_runs.h"

#include <fmt/format.h>

#include "benchmarks/plan/build_parts.h"
#include "core/errors.h"
#include "core/files.h"

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

// Asks again for what records asked for, and runs it hidden from everybody else.

namespace {

// What the record asked for, as this program asks for it.
Request same_request(const Catalog& catalog, const Record& record) {
  constexpr double kLongest = 600;  // seconds: the record has ended without a clock before
  const Request request = request_again(catalog, record, kLongest);
  require(request.cell == record.cell && build_digest(request) == record.build, [&] {
    return title_of(request) +
           ": its record is of another build; run it by this one (isoline run), or keep "
           "it without perturbations (--perturbations 0)";
  });
  return request;
}

bool is_repeated(const Record& record) {
  return !record.is_nondeterministic && record.status != Status::inapplicable;
}

}  // namespace

std::optional<std::vector<Record>> perturbed_records(const Catalog& catalog,
                                                     const std::vector<Record>& records, int number,
                                                     RunOptions options) {
  std::vector<Request> requests;
  for (const Record& record : records)
    if (is_repeated(record)) requests.push_back(same_request(catalog, record));
  const HiddenFolder folder;
  Store store(folder.path());
  options.perturbation = number;
  if (run_all(catalog, requests, store, options).is_interrupted) return std::nullopt;
  std::vector<Record> perturbed;
  for (const Request& request : requests)
    if (std::optional<Record> record = store.find(request)) perturbed.push_back(std::move(*record));
  return perturbed;
}

}  // namespace isoline::benchmarks
