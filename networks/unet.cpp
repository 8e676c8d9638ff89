// U-net (Ronneberger, Fischer, Brox 2015, fig. 1), as in PhiFlow 2.2: `levels` resolutions of
// `filters` channels each. A double convolution is twice 3×3 convolution, batch norm, rectifier;
// down by maximum pooling, up by bilinear interpolation beside the skipped level, out by a 1×1
// convolution. Batch norm always uses the statistics of the batch it is given. Deviations: none in
// exact arithmetic; a convolution's bias, which batch norm removes, has the gradient 0, not noise.

#include "networks/unet/passes.h"

namespace isoline::networks {
namespace {

class Unet final : public Network {
 public:
  Unet(const UnetOptions& options, const NetworkShape& shape) : plan_(options, shape) {}

  Index parameters() const override { return plan_.parameters; }
  Index inputs() const override { return plan_.input_channels * plan_.N * plan_.N; }
  Index outputs() const override { return plan_.output_channels * plan_.N * plan_.N; }
  Vector start(RandomStream& stream) const override { return plan_.start(stream); }
  std::vector<Block> layout() const override { return plan_.layout(); }
  bool has_independent_samples() const override { return false; }
  bool is_single_precision() const override { return true; }
  bool has_kinks() const override { return true; }
  bool has_curvature() const override { return true; }
  bool has_layer_moments() const override { return true; }

  void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const override {
    UnetState& state = ready(theta, in, w);
    unet_forward(plan_, state, in);
    unet_output(plan_, state, x);
  }
  void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const override {
    UnetState& state = w.as<UnetState>();
    state.fit(plan_, state.samples, true);
    state.set_tangent(plan_, v);
    unet_pushforward(plan_, state, Jv);
  }
  void pullback(BatchRef u, VectorOut JTu, Workspace& w) const override {
    unet_pullback(plan_, w.as<UnetState>(), u, JTu);
  }
  void curvature(VectorRef, BatchRef u, BatchRef du, VectorOut out, Workspace& w) const override {
    unet_curvature(plan_, w.as<UnetState>(), u, du, out);
  }
  void layer_moments(BatchRef u, std::vector<LayerMoments>& out, VectorOut JTu,
                     Workspace& w) const override {
    unet_layer_moments(plan_, w.as<UnetState>(), u, out, JTu);
  }
  Vector statistics(VectorRef theta, BatchRef in, Workspace& w) const override {
    UnetState& state = ready(theta, in, w);
    unet_forward(plan_, state, in);
    return unet_statistics(plan_, state, theta);
  }
  void infer(VectorRef theta, VectorRef statistics, BatchRef in, BatchOut x,
             Workspace& w) const override {
    UnetState& state = ready(theta, in, w);
    unet_infer(plan_, state, theta, statistics, in);
    unet_output(plan_, state, x);
  }

 private:
  UnetState& ready(VectorRef theta, BatchRef in, Workspace& w) const {
    UnetState& state = w.as<UnetState>();
    state.fit(plan_, in.cols(), false);
    state.set_value(plan_, theta);
    return state;
  }

  UnetPlan plan_;
};

}  // namespace

void register_unet(NetworkRegistry& registry) {
  registry.add({.name = "unet",
                .title = "U-net",
                .source = "Ronneberger, Fischer, Brox 2015, fig. 1; as in PhiFlow 2.2 u_net",
                .note = "Uses single precision for parameters and grids.",
                .options = option_table<UnetOptions>(),
                .make = [](const OptionValues& options, const NetworkShape& shape) {
                  return std::make_unique<Unet>(read_options<UnetOptions>(options), shape);
                }});
}

}  // namespace isoline::networks
