// Requests to models, and models to replies.
#include "benchmarks/serve/bridge_service.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/errors.h"

namespace isoline::benchmarks {
namespace {

constexpr const char* kInfo = "/Info";

HttpReply refused(const BridgeRefusal& refusal) {
  return {refusal.status(), error_text(refusal.kind, refusal.what())};
}

}  // namespace

BridgeService::BridgeService(std::deque<ServedRun>& runs) {
  for (ServedRun& run : runs) {
    ServedModels& models = served_.emplace_back(run);
    for (const View view : models.views()) {
      const std::string& name = names_.emplace_back(models.name_of(view));
      const bool is_new = models_.emplace(name, Model{&models, view}).second;
      require(is_new, [&] { return fmt::format("{} is served already", name); });
    }
  }
}

// Room for every number of a call in more digits than any has, and for a config.
std::size_t BridgeService::most_bytes() const {
  constexpr Index kRoom = 1 << 20, kNumber = 64;
  Index most = 0;
  for (const auto& [name, model] : models_) {
    const BridgeSizes sizes = model.of->sizes(model.view);
    Index numbers = 0;
    for (const Index size : sizes.inputs) numbers += 2 * size;
    for (const Index size : sizes.outputs) numbers += size;
    most = std::max(most, numbers);
  }
  return static_cast<std::size_t>(kRoom + kNumber * most);
}

std::vector<HttpRoute> BridgeService::routes() {
  std::vector<HttpRoute> all;
  const auto add = [&](const char* method, const std::string& path) {
    all.push_back({method, path, [this, path](const auto& body) { return answer(path, body); }});
  };
  add("GET", kInfo);
  for (const char* path : {"/InputSizes", "/OutputSizes", "/ModelInfo"}) add("POST", path);
  for (const char* verb : kBridgeVerbs) add("POST", std::string("/") + verb);
  return all;
}

const BridgeService::Model& BridgeService::at(const std::string& name) const {
  const auto found = models_.find(name);
  if (found == models_.end())
    throw BridgeRefusal(
        "ModelNotFound",
        fmt::format("there is no model of that name; there are: {}", fmt::join(names_, ", ")));
  return found->second;
}

HttpReply BridgeService::answer(const std::string& path, const std::string& body) {
  try {
    return {200, answered(path, body)};
  } catch (const BridgeRefusal& refusal) {
    return refused(refusal);
  } catch (const UsageError& error) {  // a physics that refuses an x
    return refused({"InvalidInput", error.what()});
  } catch (const std::exception& error) {
    return refused({"InvalidOutput", error.what()});
  }
}

// What a model does not offer it refuses before it looks at what it was given.
std::string BridgeService::answered(const std::string& path, const std::string& body) {
  if (path == kInfo) return info_text(names_);
  const BridgeRequest request(body);
  const auto& [models, view] = at(request.model());
  const BridgeSizes sizes = models->sizes(view);
  if (path == "/InputSizes") return input_sizes_text(sizes);
  if (path == "/OutputSizes") return output_sizes_text(sizes);
  if (path == "/ModelInfo") return support_text(models->support(view));
  const auto* const verb = std::ranges::find(kBridgeVerbs, path.substr(1));
  if (verb == kBridgeVerbs.end()) throw BridgeRefusal("InvalidInput", "there is no such path");
  const auto asked = static_cast<BridgeVerb>(verb - kBridgeVerbs.begin());
  models->require_offered(view, asked);
  const BridgeCall call = request.call(asked, sizes);
  const std::lock_guard lock(computing_);
  return models->answer(view, call);
}

std::string BridgeService::refusal(int status, const std::string& reason) {
  switch (status) {
    case 404:
      return error_text("InvalidInput", "UM-Bridge has no such path, or not by this method");
    case 413:
      return error_text("InvalidInput", "the body is longer than any call of these models");
    case 500:
      return error_text("InvalidOutput", reason.empty() ? "the model failed" : reason);
    default:
      return error_text("InvalidInput", reason.empty() ? "this is no request of HTTP" : reason);
  }
}

}  // namespace isoline::benchmarks
