// A trained network on disk, schema isoline.network/1: the problem, the training, θ, and the
// averaged statistics that inference uses.
#pragma once

#include <filesystem>

#include "benchmarks/plan/catalog.h"
#include "core/records/npy.h"
#include "problems/problem.h"

namespace isoline::benchmarks {

inline constexpr const char* kNetworkSchema = "isoline.network/1";

struct TrainedNetwork {
  Component problem, optimizer;
  std::uint64_t seed = 0;
  std::int64_t iterations = 0;
  Real loss = 0, x_error = 0;  // on the validation
  Vector theta, statistics;    // (n), and what Network::infer is given
};

// As JSON, whole or not at all.
void write_network(const TrainedNetwork& network, const std::filesystem::path& path);
TrainedNetwork read_network(const std::filesystem::path& path);  // UsageError if it is not valid
TrainedNetwork network_from_text(const std::string& text);       // what such a file holds

// The samples that pass through a network, averaged: what `statistics` holds.
Vector averaged_statistics(const Problem& problem, VectorRef theta, std::int64_t first_step);

// UsageError where the network is not one of this problem.
void require_fitting(const TrainedNetwork& network, const Problem& problem);

// Samples (i, S), as a file holds them: (S, i), grids row by row.
NumberArray samples_array(const Problem& problem, Matrix samples);

// x of each input. One sample along the first index: (S, i) -> (S, k), and (S, [channels,] N, N) of
// grids as pictures, row by row. UsageError where the shape does not fit.
NumberArray infer(const Problem& problem, const TrainedNetwork& network, const NumberArray& input,
                  const std::string& origin);

}  // namespace isoline::benchmarks
