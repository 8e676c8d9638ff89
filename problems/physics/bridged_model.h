// A model behind UM-Bridge, its inputs joined to one x (k) and its outputs to one y (m). Each call
// sends x anew; what the model does not support is not asked for.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/array.h"
#include "core/bridge_messages.h"
#include "core/http_client.h"
#include "problems/physics/bridge_server.h"

namespace isoline::problems {

class BridgedModel {
 public:
  // Where it is served: at an address, or by a command that is started for it.
  struct Place {
    std::string url, command;
    double startup_seconds = 30;
  };
  // An empty name is that of a server's only model. UsageError where there is no such model, or
  // nobody answers as UM-Bridge says.
  BridgedModel(const Place& place, const std::string& model, const std::string& config);

  Index inputs() const { return inputs_; }    // k
  Index outputs() const { return outputs_; }  // m
  bool supports(BridgeVerb verb) const { return support_[static_cast<std::size_t>(verb)]; }
  // What a model P.data beside it gives, y* and x₀, where there is one of these sizes.
  std::optional<std::vector<Numbers>> data();

  void evaluate(VectorRef x, VectorOut y);
  void gradient(VectorRef x, VectorRef w, VectorOut out);                    // Jᵀ w, (m) -> (k)
  void apply_jacobian(VectorRef x, VectorRef v, VectorOut out);              // J v, (k) -> (m)
  void apply_hessian(VectorRef x, VectorRef w, VectorRef v, VectorOut out);  // Σ wᵢ ∇²Pᵢ v, (k)

 private:
  std::string ask(const std::string& path, const std::string& body);
  BridgeSizes sizes_of(const std::string& model);
  void connect(std::size_t most_bytes);
  Numbers output_of(const BridgeCall& call, Index size);
  BridgeCall at(BridgeVerb verb, VectorRef x) const;

  Place place_;
  std::optional<BridgeServer> server_;
  std::unique_ptr<HttpClient> client_;
  std::vector<std::string> models_;
  std::string model_, config_;
  BridgeSizes sizes_;
  BridgeSupport support_{};
  Index inputs_ = 0, outputs_ = 0;
};

}  // namespace isoline::problems
