// Trained networks: written, read, applied.
#include "benchmarks/run/trained.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/option_json.h"

namespace isoline::benchmarks {

using problems::Batch;
namespace {

constexpr const char* kSchema = "isoline.network/1";

Json component_json(const Component& component) {
  return {
      {"name", component.name}, {"options", to_json(component.options)}, {"spec", component.spec}};
}

Component component_from(const Json& json) {
  return {.name = json.at("name"),
          .options = option_values_from(json.at("options")),
          .spec = json.at("spec")};
}

Json header_of(const TrainedNetwork& network) {
  return {{"schema", kSchema},
          {"problem", component_json(network.problem)},
          {"optimizer", component_json(network.optimizer)},
          {"seed", network.seed},
          {"iterations", network.iterations},
          {"loss", json_number(network.loss)},
          {"x_error", json_number(network.x_error)},
          {"parameters", network.theta.size()},
          {"statistics", network.statistics.size()}};
}

TrainedNetwork from_header(const Json& json) {
  require(json.at("schema") == kSchema,
          [&] { return fmt::format("its schema is not {}", kSchema); });
  TrainedNetwork network{.problem = component_from(json.at("problem")),
                         .optimizer = component_from(json.at("optimizer")),
                         .seed = json.at("seed"),
                         .iterations = json.at("iterations"),
                         .loss = real_of(json.at("loss")),
                         .x_error = real_of(json.at("x_error"))};
  network.theta.resize(json.at("parameters").get<Index>());
  network.statistics.resize(json.at("statistics").get<Index>());
  return network;
}

Json values_of(const Vector& vector) {
  return json_numbers({vector.data(), static_cast<std::size_t>(vector.size())});
}

void fill(Vector& vector, const Json& values) {
  require(static_cast<Index>(values.size()) == vector.size(), "it holds too few numbers");
  for (Index i = 0; i < vector.size(); ++i)
    vector[i] = real_of(values[static_cast<std::size_t>(i)]);
}

std::string_view bytes_of(const Vector& vector) {
  return {reinterpret_cast<const char*>(vector.data()),
          sizeof(Real) * static_cast<std::size_t>(vector.size())};
}

TrainedNetwork parsed(const std::string& text) {
  const std::size_t end = text.find('\n');
  TrainedNetwork network = from_header(parse_json(text.substr(0, end), "its header"));
  if (end + 1 >= text.size()) {
    const Json json = parse_json(text, "it");
    fill(network.theta, json.at("theta"));
    fill(network.statistics, json.at("mean_statistics"));
    return network;
  }
  const std::size_t theta = bytes_of(network.theta).size();
  const std::size_t statistics = bytes_of(network.statistics).size();
  require(text.size() - end - 1 == theta + statistics, "it is cut short");
  std::memcpy(network.theta.data(), text.data() + end + 1, theta);
  std::memcpy(network.statistics.data(), text.data() + end + 1 + theta, statistics);
  return network;
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
          [&] { return origin + ": it holds no samples"; });
  const Index each =
      std::accumulate(input.shape.begin() + 1, input.shape.end(), Index{1}, std::multiplies<>());
  require(each == inputs, [&] {
    return fmt::format("{}: its shape is ({}), {} numbers a sample, and the network takes {}",
                       origin, fmt::join(input.shape, ", "), each, inputs);
  });
  return Eigen::Map<const Matrix>(input.values.data(), inputs, input.shape[0]);
}

}  // namespace

void write_network(const TrainedNetwork& network, const std::filesystem::path& path) {
  Json json = header_of(network);
  if (path.extension() == ".json") {
    json["theta"] = values_of(network.theta);
    json["mean_statistics"] = values_of(network.statistics);
    return write_text(path, json.dump() + "\n");
  }
  std::string text = json.dump() + "\n";
  text += bytes_of(network.theta);
  text += bytes_of(network.statistics);
  write_text(path, text);
}

TrainedNetwork read_network(const std::filesystem::path& path) {
  try {
    return parsed(read_text(path));
  } catch (const std::exception& error) {  // of JSON, or ours
    throw UsageError(fmt::format("{} is no trained network: {}", path.string(), error.what()));
  }
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

NumberArray infer(const Problem& problem, const TrainedNetwork& network, const NumberArray& input,
                  const std::string& origin) {
  Matrix in = samples_of(input, problem.network().inputs(), origin);
  turn_grids(in, problem.grid());
  Matrix x(problem.inputs(), in.cols());
  Workspace workspace;
  problem.network().infer(network.theta, network.statistics, in, x, workspace);
  turn_grids(x, problem.grid());
  NumberArray output{{x.cols()}, {x.data(), x.data() + x.size()}};
  const bool is_picture = problem.grid() > 0 && input.shape.size() > 2;
  if (is_picture)
    output.shape.insert(output.shape.end(), {problem.grid(), problem.grid()});
  else
    output.shape.push_back(x.rows());
  return output;
}

}  // namespace isoline::benchmarks
