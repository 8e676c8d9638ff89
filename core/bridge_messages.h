// UM-Bridge, the field's protocol for models over HTTP (Seelinger et al. 2023, version 1.0), as
// texts: what a client asks and what a server answers, each read as well as written. A model maps
// some vectors to some others; all that its sizes, its calls and their answers hold is checked
// here.
#pragma once

#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/bridge_numbers.h"
#include "core/real.h"

namespace isoline {

struct BridgeSizes {
  std::vector<Index> inputs, outputs;  // of each vector
};

enum class BridgeVerb { evaluate, gradient, apply_jacobian, apply_hessian };
inline constexpr std::array<const char*, 4> kBridgeVerbs = {"Evaluate", "Gradient", "ApplyJacobian",
                                                            "ApplyHessian"};
inline const char* name_of(BridgeVerb verb) { return kBridgeVerbs[static_cast<std::size_t>(verb)]; }

inline constexpr Real kBridgeProtocol = 1;  // its version

using BridgeSupport = std::array<bool, 4>;  // by verb

struct BridgeCall {
  BridgeVerb verb = BridgeVerb::evaluate;
  std::vector<Numbers> input = {};
  // Which vectors are meant: of outputs one, of inputs one, or two for a Hessian.
  Index out_wrt = 0, in_wrt = 0, in_wrt2 = 0;
  Numbers sens = {};  // the cotangent, of the size of that output
  Numbers vec = {};   // the tangent, of the size of that input; of a Hessian, the second
};

// What a server says where it does not answer: one of the protocol's four kinds.
struct BridgeRefusal : std::runtime_error {
  BridgeRefusal(std::string kind_of_error, const std::string& message)
      : std::runtime_error(message), kind(std::move(kind_of_error)) {}
  int status() const { return kind == "InvalidOutput" ? 500 : 400; }

  std::string kind;  // "ModelNotFound", "UnsupportedFeature", "InvalidInput", "InvalidOutput"
};

// --- what a server reads and writes

// A body that names a model, by that name. BridgeRefusal where it is none.
class BridgeRequest {
 public:
  explicit BridgeRequest(const std::string& body);
  ~BridgeRequest();
  BridgeRequest(const BridgeRequest&) = delete;
  BridgeRequest& operator=(const BridgeRequest&) = delete;

  const std::string& model() const { return model_; }
  // Everything in it has the sizes of the model.
  BridgeCall call(BridgeVerb verb, const BridgeSizes& sizes) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
  std::string model_;
};

std::string info_text(const std::vector<std::string>& models);
std::string input_sizes_text(const BridgeSizes& sizes);
std::string output_sizes_text(const BridgeSizes& sizes);
std::string support_text(const BridgeSupport& support);
std::string outputs_text(const std::vector<Numbers>& outputs);  // of Evaluate
std::string output_text(const Numbers& output);                 // of the other verbs
std::string error_text(const std::string& kind, const std::string& message);

}  // namespace isoline
