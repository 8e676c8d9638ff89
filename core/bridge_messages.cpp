// A server's texts of UM-Bridge.
#include "core/bridge_messages.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/bridge_numbers.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/text.h"

namespace isoline {
namespace {

constexpr std::size_t kMostQuoted = 80;

[[noreturn]] void refuse(const std::string& message) {
  throw BridgeRefusal("InvalidInput", message);
}

void expect(bool holds, std::invocable auto law) {
  if (!holds) refuse(law());
}

// A list at a key, of so many numbers.
Numbers vector_at(const Json& tree, const char* key, Index size) {
  expect(tree.contains(key), [&] { return fmt::format("{} is missing", key); });
  Numbers values;
  try {
    values = numbers_of(tree.at(key));
  } catch (const UsageError& error) {
    refuse(fmt::format("{}: {}", key, error.what()));
  }
  expect(static_cast<Index>(values.size()) == size,
         [&] { return fmt::format("{} must have {} numbers, got {}", key, size, values.size()); });
  return values;
}

// Which of so many vectors.
Index which_at(const Json& tree, const char* key, const std::vector<Index>& sizes) {
  const auto count = static_cast<Index>(sizes.size());
  const auto found = tree.find(key);
  const bool is_index = found != tree.end() && found->is_number_unsigned() &&
                        found->get<std::uint64_t>() < static_cast<std::uint64_t>(count);
  expect(is_index, [&] {
    return fmt::format("{} must be an integer in [0, {}], got {}", key, count - 1,
                       found == tree.end() ? "nothing" : cut(json_text(*found), kMostQuoted));
  });
  return found->get<Index>();
}

std::vector<Numbers> input_at(const Json& tree, const std::vector<Index>& sizes) {
  const auto found = tree.find("input");
  const bool is_list = found != tree.end() && found->is_array();
  expect(is_list && found->size() == sizes.size(),
         [&] { return fmt::format("input must be a list of {} lists of numbers", sizes.size()); });
  std::vector<Numbers> input;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const Json& each = (*found)[i];
    expect(each.is_array() && static_cast<Index>(each.size()) == sizes[i],
           [&] { return fmt::format("input {} must be a list of {} numbers", i, sizes[i]); });
    try {
      input.push_back(numbers_of(each));
    } catch (const UsageError& error) {
      refuse(fmt::format("input {}: {}", i, error.what()));
    }
  }
  return input;
}

}  // namespace

struct BridgeRequest::Tree {
  Json json;
};

BridgeRequest::BridgeRequest(const std::string& body) {
  auto tree = std::make_unique<Tree>();
  try {
    tree->json = bridge_json(body, "the body");
  } catch (const UsageError& error) {
    refuse(error.what());
  }
  expect(tree->json.is_object(), [] { return "the body must be an object"; });
  const auto name = tree->json.find("name");
  expect(name != tree->json.end() && name->is_string(),
         [] { return "name must be the name of a model"; });
  model_ = name->get<std::string>();
  tree_ = std::move(tree);
}
BridgeRequest::~BridgeRequest() = default;

BridgeCall BridgeRequest::call(BridgeVerb verb, const BridgeSizes& sizes) const {
  const Json& tree = tree_->json;
  expect(!tree.contains("config") || tree.at("config").is_object(),
         [] { return "config must be an object"; });
  BridgeCall call{.verb = verb, .input = input_at(tree, sizes.inputs)};
  if (verb == BridgeVerb::evaluate) return call;
  const bool is_hessian = verb == BridgeVerb::apply_hessian;
  call.out_wrt = which_at(tree, "outWrt", sizes.outputs);
  call.in_wrt = which_at(tree, is_hessian ? "inWrt1" : "inWrt", sizes.inputs);
  if (is_hessian) call.in_wrt2 = which_at(tree, "inWrt2", sizes.inputs);
  if (verb != BridgeVerb::apply_jacobian)
    call.sens = vector_at(tree, "sens", sizes.outputs[static_cast<std::size_t>(call.out_wrt)]);
  const Index along = is_hessian ? call.in_wrt2 : call.in_wrt;
  if (verb != BridgeVerb::gradient)
    call.vec = vector_at(tree, "vec", sizes.inputs[static_cast<std::size_t>(along)]);
  return call;
}

std::string info_text(const std::vector<std::string>& models) {
  return json_text({{"protocolVersion", kBridgeProtocol}, {"models", models}});
}

std::string input_sizes_text(const BridgeSizes& sizes) {
  return json_text({{"inputSizes", sizes.inputs}});
}

std::string output_sizes_text(const BridgeSizes& sizes) {
  return json_text({{"outputSizes", sizes.outputs}});
}

std::string support_text(const BridgeSupport& support) {
  Json verbs = Json::object();
  for (std::size_t verb = 0; verb < support.size(); ++verb)
    verbs[kBridgeVerbs[verb]] = support[verb];
  return json_text({{"support", verbs}});
}

std::string outputs_text(const std::vector<Numbers>& outputs) {
  std::string text = "{\"output\":";
  append_vectors(text, outputs);
  return text + "}";
}

std::string output_text(const Numbers& output) {
  std::string text = "{\"output\":";
  append_numbers(text, output);
  return text + "}";
}

std::string error_text(const std::string& kind, const std::string& message) {
  return json_text({{"error", {{"type", kind}, {"message", message}}}});
}

}  // namespace isoline
