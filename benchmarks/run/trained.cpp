// Writes, reads and applies trained networks.
#include "benchmarks/run/trained.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

#include "benchmarks/plan/catalog.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/options.h"
#include "core/output.h"
#include "core/records/json_view.h"
#include "core/text.h"

namespace isoline::benchmarks {

using problems::Batch;
namespace {

Json component_json(const Component& component) {
  return {
      {"name", component.name}, {"options", to_json(component.options)}, {"spec", component.spec}};
}

Component component_from(const Json& json) {
  return {.name = json.at("name"),
          .options = option_values_from(json.at("options")),
          .spec = json.at("spec")};
}

Json values_of(const Vector& vector) {
  return json_numbers({vector.data(), static_cast<std::size_t>(vector.size())});
}

// The numbers of a list, which leaves the document: the schema holds the rest.
Vector taken(Json& json, const char* list) {
  require(json.contains(list), [&] { return fmt::format("it has no \"{}\"", list); });
  require(json[list].is_array(), [&] { return fmt::format("its \"{}\" is not a list", list); });
  const std::vector<Real> values = reals_of(json[list]);
  json.erase(list);
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

void require_count(const Json& json, const char* name, Index there) {
  const auto said = json.at(name).get<std::uint64_t>(), found = static_cast<std::uint64_t>(there);
  require(said == found, [&] {
    return fmt::format("its \"{}\" is {}, but it has {} numbers", name, count_text(said),
                       count_text(found));
  });
}

// N where samples are N×N grids, else 0.
Index side_of_grid(const Problem& problem) {
  const auto& field = problem.field();
  return field && !field->is_history() && field->rows == field->columns ? field->rows : 0;
}

// A picture is stored row by row, a field column by column: each N×N block is transposed.
void turn_grids(Matrix& samples, Index N) {
  if (N == 0) return;
  for (Index b = 0; b < samples.cols(); ++b)
    for (Index begin = 0; begin < samples.rows(); begin += N * N)
      samples.col(b).segment(begin, N * N).reshaped(N, N).transposeInPlace();
}

Matrix samples_of(const NumberArray& input, Index inputs, const std::string& origin) {
  require(!input.shape.empty() && input.shape[0] > 0,
          [&] { return origin + ": it has no samples"; });
  const Index each =
      std::accumulate(input.shape.begin() + 1, input.shape.end(), Index{1}, std::multiplies<>());
  require(each == inputs, [&] {
    return fmt::format("{}: its shape is ({}), {} numbers per sample, but the network takes {}",
                       origin, fmt::join(input.shape, ", "), each, inputs);
  });
  return Eigen::Map<const Matrix>(input.values.data(), inputs, input.shape[0]);
}

}  // namespace

void write_network(const TrainedNetwork& network, const std::filesystem::path& path) {
  const Json json{{"schema", kNetworkSchema},
                  {"problem", component_json(network.problem)},
                  {"optimizer", component_json(network.optimizer)},
                  {"seed", network.seed},
                  {"iterations", network.iterations},
                  {"loss", json_number(network.loss)},
                  {"x_error", json_number(network.x_error)},
                  {"parameters", network.theta.size()},
                  {"statistics", network.statistics.size()},
                  {"theta", values_of(network.theta)},
                  {"mean_statistics", values_of(network.statistics)}};
  write_output(path, json_text(json) + "\n", kNetworkSchema);
}

TrainedNetwork network_from_text(const std::string& text) {
  static const Schema schema(parse_json(std::string(builtin_schemas().at("network")), "schema"));
  Json json = parse_json(text, "it");
  require(json.is_object(), "it is not a JSON object");
  const Vector theta = taken(json, "theta"), statistics = taken(json, "mean_statistics");
  const std::vector<std::string> violations = schema.violations(json);
  require(violations.empty(), [&] { return violations[0]; });
  require_count(json, "parameters", theta.size());
  require_count(json, "statistics", statistics.size());
  return {.problem = component_from(json.at("problem")),
          .optimizer = component_from(json.at("optimizer")),
          .seed = json.at("seed"),
          .iterations = json.at("iterations"),
          .loss = real_of(json.at("loss")),
          .x_error = real_of(json.at("x_error")),
          .theta = theta,
          .statistics = statistics};
}

TrainedNetwork read_network(const std::filesystem::path& path) {
  require(is_there(path), [&] { return fmt::format("{}: no such file", path.string()); });
  try {
    return network_from_text(read_text(path));
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{} is not a trained network: {}", path.string(), error.what()));
  }
}

void require_fitting(const TrainedNetwork& network, const Problem& problem) {
  const auto require_size = [](const char* what, Index held, Index wanted) {
    require(held == wanted, [&] {
      return fmt::format("it has {} {}, but its network has {}", held, what, wanted);
    });
  };
  require_size("parameters", network.theta.size(), problem.unknowns());
  Batch batch;
  Workspace workspace;
  problem.draw_batch(0, batch);
  const Vector one = problem.network().statistics(network.theta, batch.input, workspace);
  require_size("statistics", network.statistics.size(), one.size());
}

Vector averaged_statistics(const Problem& problem, VectorRef theta, std::int64_t first_step) {
  constexpr int kBatches = 16;
  Vector sum;
  Batch batch;
  Workspace workspace;
  for (int i = 0; i < kBatches; ++i) {
    problem.draw_batch(first_step + i, batch);
    const Vector one = problem.network().statistics(theta, batch.input, workspace);
    if (i == 0) sum = Vector::Zero(one.size());
    sum += one;
  }
  return sum / kBatches;
}

NumberArray samples_array(const Problem& problem, Matrix samples) {
  turn_grids(samples, side_of_grid(problem));
  return {{samples.cols(), samples.rows()}, {samples.data(), samples.data() + samples.size()}};
}

NumberArray infer(const Problem& problem, const TrainedNetwork& network, const NumberArray& input,
                  const std::string& origin) {
  constexpr Index kAtOnce = 1024;  // samples: all layers of all of them need not be held
  Matrix in = samples_of(input, problem.network().inputs(), origin);
  turn_grids(in, side_of_grid(problem));
  Matrix x(problem.inputs(), in.cols());
  Workspace workspace;
  for (Index first = 0; first < in.cols(); first += kAtOnce) {
    const Matrix some = in.middleCols(first, std::min(kAtOnce, in.cols() - first));
    Matrix inferred(x.rows(), some.cols());
    problem.network().infer(network.theta, network.statistics, some, inferred, workspace);
    x.middleCols(first, some.cols()) = inferred;
  }
  NumberArray output = samples_array(problem, std::move(x));
  const Index side = side_of_grid(problem);
  if (side > 0 && input.shape.size() > 2) output.shape = {output.shape[0], side, side};
  return output;
}

}  // namespace isoline::benchmarks
