// A seed names an instance and a start. A plain seed names both alike; a pair of different ones is
// the number 1,000,000 + 1,000 instance + start, so that plain seeds keep their cells and digests.
//
// To the instance belong the target, the context, the truth, the validation samples and training
// samples that are finite in number; to the start θ₀, initial weights, and fresh training samples,
// whose order is the noise of a run. The instance of seed 0 and the start of seed 0 are published.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace isoline {

inline constexpr std::uint64_t kFirstPair = 1'000'000, kPairLimit = 1'000;  // of either part

constexpr bool is_pair(std::uint64_t seed) {
  return seed >= kFirstPair && seed < kFirstPair + kPairLimit * kPairLimit;
}
constexpr std::uint64_t instance_of(std::uint64_t seed) {
  return is_pair(seed) ? (seed - kFirstPair) / kPairLimit : seed;
}
constexpr std::uint64_t start_of(std::uint64_t seed) {
  return is_pair(seed) ? (seed - kFirstPair) % kPairLimit : seed;
}
// Both below kPairLimit unless they are equal.
constexpr std::uint64_t seed_of(std::uint64_t instance, std::uint64_t start) {
  return instance == start ? start : kFirstPair + kPairLimit * instance + start;
}
// "3", or "2:1" for instance 2 and start 1: as --seeds =… reads it.
inline std::string seed_text(std::uint64_t seed) {
  std::string text = std::to_string(instance_of(seed));
  if (is_pair(seed)) text.append(":").append(std::to_string(start_of(seed)));
  return text;
}

// The number of different instances or starts of some seeds. The greater of both is that of
// independent values; more seeds than that repeat an instance or a start.
inline std::size_t distinct(const std::vector<std::uint64_t>& seeds,
                            std::uint64_t (*part)(std::uint64_t)) {
  std::set<std::uint64_t> all;
  for (const std::uint64_t seed : seeds) all.insert(part(seed));
  return all.size();
}

}  // namespace isoline
