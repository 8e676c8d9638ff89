// Requests made anew, and folders by mkdtemp.
#include "benchmarks/run/again.h"

#include <fmt/format.h>
#include <stdlib.h>

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

HiddenFolder::HiddenFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "isoline-XXXXXX").string();
  require(mkdtemp(pattern.data()) != nullptr,
          [&] { return fmt::format("cannot make a folder {}", pattern); });
  path_ = pattern;
}

HiddenFolder::~HiddenFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace isoline::benchmarks
