// Asks again for what records asked for, and runs it hidden from everybody else.
#include "benchmarks/run/perturbed_runs.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <filesystem>

#include "benchmarks/plan/build_parts.h"
#include "core/errors.h"

namespace isoline::benchmarks {
namespace {

// Records of perturbed runs have the cells of the others: nobody else may find them.
class HiddenFolder {
 public:
  HiddenFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "isoline-XXXXXX").string();
    require(mkdtemp(pattern.data()) != nullptr,
            [&] { return fmt::format("cannot make a folder {}", pattern); });
    path_ = pattern;
  }
  ~HiddenFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  HiddenFolder(const HiddenFolder&) = delete;
  HiddenFolder& operator=(const HiddenFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// What the record asked for, as this program asks for it.
Request request_again(const Catalog& catalog, const Record& record) {
  Request request = record.request;
  const auto title = [&] {
    return fmt::format("{} × {}, seed {}", request.problem.spec, request.optimizer.spec,
                       request.seed);
  };
  request.problem = complete_problem(catalog, request.problem.name, request.problem.options);
  request.optimizer =
      complete_optimizer(catalog, request.optimizer.name, request.optimizer.options);
  request.problem.asked = record.request.problem.asked;
  request.optimizer.asked = record.request.optimizer.asked;
  constexpr double kLongest = 600;  // seconds: the record has ended without a clock before
  request.hard_seconds = kLongest;
  const bool is_same = cell_digest(request) == record.cell && build_digest(request) == record.build;
  require(is_same, [&] {
    return title() +
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
    if (is_repeated(record)) requests.push_back(request_again(catalog, record));
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
