// Records and plans: read, and written as they were read.
#include "core/records/record.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/records/plan.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {

void record(std::string_view bytes) {
  const std::string text(bytes);
  expect_read_or_refused([&] {
    const std::string written = to_json(record_from_text(text, "the input")).dump();
    if (to_json(record_from_text(written, "its copy")).dump() != written)
      throw std::logic_error("a record came back changed");
  });
  expect_read_or_refused([&] { to_json(plan_from_text(text, "the input")).dump(); });
}

}  // namespace isoline::fuzz
