// Suites: read, counted and expanded over the components of the tree.
#include "benchmarks/plan/suite.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/json.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {

void suite(std::string_view bytes) {
  constexpr std::uint64_t kMost = 500;
  static const benchmarks::Rates rates = benchmarks::Rates::builtin();
  expect_read_or_refused([&] {
    const benchmarks::Suite read =
        benchmarks::suite_from_json(parse_json(std::string(bytes), "the input"), "the input");
    const benchmarks::PlanSize size = size_of(catalog(), read);
    const auto requests = expand(catalog(), read, rates, kMost);
    if (requests.size() > size.cells) throw std::logic_error("more cells than were counted");
  });
}

}  // namespace isoline::fuzz
