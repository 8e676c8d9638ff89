// A client's texts of UM-Bridge.
#include "core/bridge_answers.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/text.h"

namespace isoline {
namespace {

constexpr Index kMostNumbers = 1 << 27;  // of all vectors of a model: 1 GiB
constexpr std::size_t kMostVectors = 1 << 16, kMostQuoted = 80;

Json answer_of(const std::string& text, const char* key) {
  Json tree = bridge_json(text, "the answer");
  require(tree.is_object() && tree.contains(key), [&] {
    return fmt::format("an answer with {} was expected, got {}", key, cut(text, kMostQuoted));
  });
  return std::move(tree.at(key));
}

// Of vectors: a bounded number of them, of a bounded size in all.
std::vector<Index> sizes_of(const Json& list, const char* key) {
  const auto law = [&] {
    return fmt::format("{} must be a list of positive integers, got {}", key,
                       cut(json_text(list), kMostQuoted));
  };
  require(list.is_array() && !list.empty() && list.size() <= kMostVectors, law);
  std::vector<Index> sizes;
  Index total = 0;
  for (const Json& size : list) {
    const bool is_size =
        size.is_number_unsigned() && size.get<std::uint64_t>() <= std::uint64_t{kMostNumbers};
    require(is_size, law);
    total += sizes.emplace_back(size.get<Index>());
  }
  require(total > 0 && total <= kMostNumbers, law);
  return sizes;
}

}  // namespace

std::string name_text(const std::string& model, const std::string& config) {
  return fmt::format("{{\"name\":{},\"config\":{}}}", json_text(model), config);
}

std::string call_text(const std::string& model, const std::string& config, const BridgeCall& call) {
  std::string text =
      fmt::format("{{\"name\":{},\"config\":{},\"input\":", json_text(model), config);
  append_vectors(text, call.input);
  const bool is_hessian = call.verb == BridgeVerb::apply_hessian;
  if (call.verb != BridgeVerb::evaluate)
    text += fmt::format(",\"outWrt\":{},\"{}\":{}", call.out_wrt, is_hessian ? "inWrt1" : "inWrt",
                        call.in_wrt);
  if (is_hessian) text += fmt::format(",\"inWrt2\":{}", call.in_wrt2);
  if (!call.sens.empty()) {
    text += ",\"sens\":";
    append_numbers(text, call.sens);
  }
  if (!call.vec.empty()) {
    text += ",\"vec\":";
    append_numbers(text, call.vec);
  }
  return text + "}";
}

std::vector<std::string> models_in(const std::string& info) {
  const Json tree = bridge_json(info, "the answer");
  const bool is_info =
      tree.is_object() && tree.contains("models") && tree.contains("protocolVersion");
  require(is_info, [&] {
    return fmt::format("it is no server of UM-Bridge: its info is {}", cut(info, kMostQuoted));
  });
  const Json& version = tree.at("protocolVersion");
  require(version.is_number() && version.get<Real>() == kBridgeProtocol, [&] {
    return fmt::format("its protocol is {}, and must be {:.1f}", json_text(version),
                       kBridgeProtocol);
  });
  std::vector<std::string> models;
  const Json& names = tree.at("models");
  require(names.is_array(), "its info names no models");
  for (const Json& name : names)
    if (name.is_string()) models.push_back(name.get<std::string>());
  return models;
}

std::vector<Index> input_sizes_in(const std::string& answer) {
  return sizes_of(answer_of(answer, "inputSizes"), "inputSizes");
}

std::vector<Index> output_sizes_in(const std::string& answer) {
  return sizes_of(answer_of(answer, "outputSizes"), "outputSizes");
}

BridgeSupport support_in(const std::string& answer) {
  const Json tree = answer_of(answer, "support");
  BridgeSupport support{};
  for (std::size_t verb = 0; verb < support.size(); ++verb) {
    const auto found = tree.is_object() ? tree.find(kBridgeVerbs[verb]) : tree.end();
    support[verb] = found != tree.end() && found->is_boolean() && found->get<bool>();
  }
  return support;
}

std::vector<Numbers> outputs_in(const std::string& answer) {
  const Json list = answer_of(answer, "output");
  require(list.is_array(), "the output of Evaluate is no list of lists of numbers");
  std::vector<Numbers> outputs;
  for (const Json& each : list) outputs.push_back(numbers_of(each));
  return outputs;
}

Numbers output_in(const std::string& answer) { return numbers_of(answer_of(answer, "output")); }

std::string error_in(const std::string& answer) {
  Json tree;
  try {
    tree = bridge_json(answer, "the answer");
  } catch (const UsageError&) {
    return "";
  }
  if (!tree.is_object() || !tree.contains("error")) return "";
  const Json& error = tree.at("error");
  const auto text = [&](const char* key) {
    const bool has = error.is_object() && error.contains(key) && error.at(key).is_string();
    return has ? error.at(key).get<std::string>() : "?";
  };
  return fmt::format("{}: {}", text("type"), text("message"));
}

Numbers numbers_in(const std::string& json, const std::string& origin) {
  return numbers_of(bridge_json(json, origin));
}

std::string config_in(const std::string& json, const std::string& origin) {
  const Json tree = parse_json(json, origin);
  require(tree.is_object(), [&] { return origin + " must be a JSON object"; });
  return json_text(tree);
}

}  // namespace isoline
