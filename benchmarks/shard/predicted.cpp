// Predictions written and read without a tree of them: plans have cells by the hundred thousand.
#include "benchmarks/shard/predicted.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

#include "benchmarks/run/prediction.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/json_view.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

// Of no run in seconds: what a step costs at least in forward solves is the same for all.
double declared_work(const Request& request) {
  constexpr double kWorkPerIteration = 3;
  return std::min(static_cast<double>(request.budget.work),
                  kWorkPerIteration * static_cast<double>(request.budget.iterations));
}

std::vector<double> weights_of(const std::vector<const Request*>& requests,
                               const fs::path& folder) {
  const auto predicted = read_predicted(folder);
  std::unordered_map<std::string, double> seconds;
  if (predicted)
    for (const PredictedCell& one : *predicted) seconds.emplace(one.cell, one.seconds);
  std::vector<double> weights;
  std::size_t unknown = 0;
  for (const Request* request : requests) {
    const auto at = seconds.find(request->cell);
    unknown += predicted && at == seconds.end();
    weights.push_back(at == seconds.end() ? declared_work(*request) : at->second);
  }
  require(unknown == 0, [&] {
    return fmt::format(
        "{} predicts another plan: it has {} of this one's {} cells; give this plan another --out",
        predicted_file(folder).string(), requests.size() - unknown, requests.size());
  });
  return weights;
}

}  // namespace

fs::path predicted_file(const fs::path& folder) { return folder / "predicted.json"; }

std::string file_text(const std::vector<PredictedCell>& cells) {
  std::string text = fmt::format("{{\"schema\": \"{}\", \"cells\": [", kPredictedSchema);
  const char* between = "\n";
  for (const PredictedCell& one : cells) {
    text += fmt::format("{}{{\"cell\": \"{}\", \"seconds\": {}}}", between, one.cell, one.seconds);
    between = ",\n";
  }
  return text + "\n]}\n";
}

std::vector<PredictedCell> predicted_from_text(const std::string& text, const std::string& origin) {
  JsonReader reader;
  const JsonView json = reader.parse(text, origin);
  try {
    require(json.at("schema").get<std::string>() == kPredictedSchema, "its schema is another");
    std::vector<PredictedCell> cells;
    for (const JsonView& one : json.at("cells").values()) {
      cells.push_back({one.at("cell"), real_of(one.at("seconds"))});
      require(cells.back().seconds > 0, "a cell takes no time");
    }
    return cells;
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: no {}: {}", origin, kPredictedSchema, error.what()));
  }
}

std::optional<std::vector<PredictedCell>> read_predicted(const fs::path& folder) {
  const fs::path file = predicted_file(folder);
  if (!is_there(file)) return std::nullopt;
  return predicted_from_text(read_text(file), file.string());
}

Weights keep_predictions(const fs::path& folder, Preview& shown) {
  if (!is_there(predicted_file(folder))) {
    if (!names_in(folder / "shards").empty()) return Weights::declared;
    std::vector<PredictedCell> cells;
    for (const PreviewedCell& one : shown.cells)
      cells.push_back({one.request->cell, std::max(one.seconds, kProcessSeconds)});
    std::error_code error;
    fs::create_directories(folder, error);  // where it cannot be made the next line says so
    write_text(predicted_file(folder), file_text(cells));
    return Weights::written;
  }
  std::vector<const Request*> requests;
  for (const PreviewedCell& one : shown.cells) requests.push_back(one.request);
  const std::vector<double> weights = weights_of(requests, folder);
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (shown.cells[i].seconds > 0) shown.cells[i].seconds = weights[i];
  return Weights::kept;
}

std::vector<double> weights_of(const std::vector<Request>& requests, const fs::path& folder) {
  std::vector<const Request*> all;
  for (const Request& request : requests) all.push_back(&request);
  return weights_of(all, folder);
}

}  // namespace isoline::benchmarks
