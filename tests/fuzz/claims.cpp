// Claims: read, and their cells expanded.
#include <nlohmann/json.hpp>

#include "benchmarks/plan/claim_cells.h"
#include "core/json.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {

void claims(std::string_view bytes) {
  static const benchmarks::Rates rates = benchmarks::Rates::builtin();
  expect_read_or_refused([&] {
    const Json json = parse_json(std::string(bytes), "the input");
    benchmarks::claims_from_json(catalog(), rates, json, "the input");
  });
}

}  // namespace isoline::fuzz
