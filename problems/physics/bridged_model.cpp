// Calls over HTTP, a vector of x at a time.
#include "problems/physics/bridged_model.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/bridge_answers.h"
#include "core/errors.h"
#include "core/text.h"

namespace isoline::problems {
namespace {

constexpr double kPatience = 86'400;  // seconds: how long a call may take is the cell's affair
constexpr std::size_t kMostTold = 16 << 20;  // bytes of what a server tells of its models
constexpr Index kNumberBytes = 64;           // of one as text, spaces included

Index sum(const std::vector<Index>& sizes) {
  return std::accumulate(sizes.begin(), sizes.end(), Index{0});
}

// Vectors that stand one behind another, as lists.
std::vector<Numbers> parts_of(VectorRef whole, const std::vector<Index>& sizes) {
  std::vector<Numbers> parts;
  const Real* from = whole.data();
  for (const Index size : sizes) {
    parts.emplace_back(from, from + size);
    from += size;
  }
  return parts;
}

Eigen::Map<const Vector> vector_of(const Numbers& values) {
  return {values.data(), static_cast<Index>(values.size())};
}

// No JSON says them, and many servers could not read them: the model has no value there.
bool is_out(VectorRef x, VectorOut out) {
  if (is_finite(x)) return false;
  out.setConstant(std::nan(""));
  return true;
}

}  // namespace

BridgedModel::BridgedModel(const Place& place, const std::string& model, const std::string& config)
    : place_(place), model_(model), config_(config) {
  if (place_.url.empty()) {
    server_.emplace(place_.command, place_.startup_seconds);
    place_.url = server_->url();
  }
  connect(kMostTold);
  models_ = models_in(ask("/Info", ""));
  if (model_.empty() && models_.size() == 1) model_ = models_.front();
  require(std::ranges::find(models_, model_) != models_.end(), [&] {
    return fmt::format("model must be one that the server has, which are {}; got '{}'",
                       fmt::join(models_, ", "), model_);
  });
  sizes_ = sizes_of(model_);
  inputs_ = sum(sizes_.inputs);
  outputs_ = sum(sizes_.outputs);
  support_ = support_in(ask("/ModelInfo", name_text(model_, config_)));
  require(supports(BridgeVerb::evaluate),
          [&] { return fmt::format("the model '{}' does not support Evaluate", model_); });
  connect(kMostTold + static_cast<std::size_t>(kNumberBytes * (inputs_ + outputs_)));
}

void BridgedModel::connect(std::size_t most_bytes) {
  client_ = std::make_unique<HttpClient>(place_.url, kPatience, most_bytes);
}

BridgeSizes BridgedModel::sizes_of(const std::string& model) {
  const std::string name = name_text(model, config_);
  return {input_sizes_in(ask("/InputSizes", name)), output_sizes_in(ask("/OutputSizes", name))};
}

// The answer's text; what else comes of it names the server, and how that ended.
std::string BridgedModel::ask(const std::string& path, const std::string& body) {
  constexpr int kGood = 200;
  constexpr std::size_t kMostQuoted = 200;
  HttpReply reply;
  try {
    reply = body.empty() ? client_->get(path) : client_->post(path, body);
  } catch (const HttpFailure& failure) {
    throw HttpFailure(server_ ? fmt::format("{}; {}", failure.what(), server_->end_in_words())
                              : failure.what());
  }
  const std::string error = error_in(reply.body);
  if (error.empty() && reply.status == kGood) return std::move(reply.body);
  throw HttpFailure(fmt::format(
      "{}{} was refused by the model '{}': {}", place_.url, path, model_,
      error.empty() ? fmt::format("status {}: {}", reply.status, cut(reply.body, kMostQuoted))
                    : error));
}

std::optional<std::vector<Numbers>> BridgedModel::data() {
  const std::string name = model_ + ".data";
  if (std::ranges::find(models_, name) == models_.end()) return std::nullopt;
  const std::string call = call_text(name, config_, {});
  std::vector<Numbers> found = outputs_in(ask("/Evaluate", call));
  const bool fits = found.size() == 2 && static_cast<Index>(found[0].size()) == outputs_ &&
                    static_cast<Index>(found[1].size()) == inputs_;
  return fits ? std::optional(std::move(found)) : std::nullopt;
}

BridgeCall BridgedModel::at(BridgeVerb verb, VectorRef x) const {
  return {.verb = verb, .input = parts_of(x, sizes_.inputs)};
}

Numbers BridgedModel::output_of(const BridgeCall& call, Index size) {
  const std::string path = std::string("/") + name_of(call.verb);
  Numbers output = output_in(ask(path, call_text(model_, config_, call)));
  require(static_cast<Index>(output.size()) == size, [&] {
    return fmt::format("{} of the model '{}' must give {} numbers, and gave {}", path, model_, size,
                       output.size());
  });
  return output;
}

void BridgedModel::evaluate(VectorRef x, VectorOut y) {
  if (is_out(x, y)) return;
  const std::string call = call_text(model_, config_, at(BridgeVerb::evaluate, x));
  const std::vector<Numbers> outputs = outputs_in(ask("/Evaluate", call));
  const auto law = [&] {
    return fmt::format("/Evaluate of the model '{}' must give {} numbers in {} lists", model_,
                       outputs_, sizes_.outputs.size());
  };
  require(outputs.size() == sizes_.outputs.size(), law);
  Index row = 0;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    require(static_cast<Index>(outputs[i].size()) == sizes_.outputs[i], law);
    y.segment(row, sizes_.outputs[i]) = vector_of(outputs[i]);
    row += sizes_.outputs[i];
  }
}

// Each input's part of the cotangent is the sum of what comes back to it from every output.
void BridgedModel::gradient(VectorRef x, VectorRef w, VectorOut out) {
  if (is_out(x, out)) return;
  BridgeCall call = at(BridgeVerb::gradient, x);
  const std::vector<Numbers> sens = parts_of(w, sizes_.outputs);
  out.setZero();
  Index row = 0;
  for (std::size_t in = 0; in < sizes_.inputs.size(); ++in) {
    for (std::size_t from = 0; from < sens.size(); ++from) {
      call.in_wrt = static_cast<Index>(in);
      call.out_wrt = static_cast<Index>(from);
      call.sens = sens[from];
      out.segment(row, sizes_.inputs[in]) += vector_of(output_of(call, sizes_.inputs[in]));
    }
    row += sizes_.inputs[in];
  }
}

void BridgedModel::apply_jacobian(VectorRef x, VectorRef v, VectorOut out) {
  if (is_out(x, out)) return;
  BridgeCall call = at(BridgeVerb::apply_jacobian, x);
  const std::vector<Numbers> along = parts_of(v, sizes_.inputs);
  out.setZero();
  Index row = 0;
  for (std::size_t to = 0; to < sizes_.outputs.size(); ++to) {
    for (std::size_t in = 0; in < along.size(); ++in) {
      call.in_wrt = static_cast<Index>(in);
      call.out_wrt = static_cast<Index>(to);
      call.vec = along[in];
      out.segment(row, sizes_.outputs[to]) += vector_of(output_of(call, sizes_.outputs[to]));
    }
    row += sizes_.outputs[to];
  }
}

void BridgedModel::apply_hessian(VectorRef x, VectorRef w, VectorRef v, VectorOut out) {
  if (is_out(x, out)) return;
  BridgeCall call = at(BridgeVerb::apply_hessian, x);
  const std::vector<Numbers> sens = parts_of(w, sizes_.outputs), along = parts_of(v, sizes_.inputs);
  out.setZero();
  Index row = 0;
  for (std::size_t first = 0; first < along.size(); ++first) {
    for (std::size_t second = 0; second < along.size(); ++second)
      for (std::size_t from = 0; from < sens.size(); ++from) {
        call.in_wrt = static_cast<Index>(first);
        call.in_wrt2 = static_cast<Index>(second);
        call.out_wrt = static_cast<Index>(from);
        call.sens = sens[from];
        call.vec = along[second];
        out.segment(row, sizes_.inputs[first]) += vector_of(output_of(call, sizes_.inputs[first]));
      }
    row += sizes_.inputs[first];
  }
}

}  // namespace isoline::problems
