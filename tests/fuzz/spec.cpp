// The specification parser: specs, seeds and durations.
#include "core/spec.h"

#include <cmath>
#include <stdexcept>

#include "tests/fuzz/targets.h"

namespace isoline::fuzz {
namespace {

constexpr std::uint64_t kMost = 1000;

// A value written as text comes back as it was.
void expect_round_trip(const std::string& value) {
  const Spec again = parse_spec("name[key=" + quoted(value) + "]");
  if (again.options.at(0).second != value) throw std::logic_error("a value came back changed");
}

}  // namespace

void spec(std::string_view bytes) {
  expect_read_or_refused([&] {
    for (const SweepSize& size : sweep_sizes(bytes))
      if (size.settings == 0) throw std::logic_error("a sweep of nothing");
    for (const Spec& each : parse_specs(bytes, kMost)) {
      options_of(each);
      for (const auto& [key, value] : each.options) expect_round_trip(value);
    }
  });
  expect_read_or_refused([&] {
    const std::size_t count = parse_seeds(bytes, kMost).size();
    if (count == 0 || count > kMost) throw std::logic_error("seeds that were not asked for");
  });
  expect_read_or_refused([&] {
    const double seconds = parse_duration(bytes);
    if (!(seconds > 0 && std::isfinite(seconds))) throw std::logic_error("no time at all");
  });
}

}  // namespace isoline::fuzz
