// Files of trained networks, schema isoline.network/1.
#include "benchmarks/run/trained.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {

void network(std::string_view bytes) {
  expect_read_or_refused([&] { benchmarks::network_from_text(std::string(bytes)); });
}

}  // namespace isoline::fuzz
