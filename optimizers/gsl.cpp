// The adapter to gsl_multifit_nlinear of the GNU Scientific Library, on r = (y − y*)/√B: trust
// regions by QR, with Levenberg-Marquardt, geodesic acceleration (Transtrum, Sethna 2012), doglegs
// and the plane of steepest descent and Gauss-Newton. Each accepted step is an iteration; GSL gives
// up after fifteen rejected steps. By default its tolerances are zero.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>

#include <memory>
#include <string>
#include <utility>

#include "optimizers/optimizer.h"
#include "optimizers/residual_calls.h"

namespace isoline::optimizers {
namespace {

constexpr const char* kAccelerated = "lmaccel";

struct GslOptions {
  std::string trust_region = "lm", scale = "more";
  Real xtol = 0, gtol = 0;
};
void fields(GslOptions& o, auto& field) {
  field("trust-region", o.trust_region,
        Choices{"lm", kAccelerated, "dogleg", "ddogleg", "subspace2D"},
        "how a step within the radius is found");
  field("scale", o.scale, Choices{"more", "levenberg", "marquardt"}, "what D is");
  field("xtol", o.xtol, at_least(0), "relative change of each unknown at which it stops");
  field("gtol", o.gtol, at_least(0), "max |gᵢ| max(|θᵢ|, 1) over max(½‖r‖², 1) at which it stops");
}

gsl_multifit_nlinear_parameters parameters_of(const GslOptions& o) {
  gsl_multifit_nlinear_parameters all = gsl_multifit_nlinear_default_parameters();
  const std::pair<const char*, const gsl_multifit_nlinear_trs*> regions[] = {
      {"lm", gsl_multifit_nlinear_trs_lm},
      {kAccelerated, gsl_multifit_nlinear_trs_lmaccel},
      {"dogleg", gsl_multifit_nlinear_trs_dogleg},
      {"ddogleg", gsl_multifit_nlinear_trs_ddogleg},
      {"subspace2D", gsl_multifit_nlinear_trs_subspace2D}};
  for (const auto& [name, region] : regions)
    if (o.trust_region == name) all.trs = region;
  all.scale = o.scale == "levenberg"   ? gsl_multifit_nlinear_scale_levenberg
              : o.scale == "marquardt" ? gsl_multifit_nlinear_scale_marquardt
                                       : gsl_multifit_nlinear_scale_more;
  return all;
}

int answer(bool is_running) { return is_running ? GSL_SUCCESS : GSL_EBADFUNC; }

// Its elements may lie apart, as those of a row do.
Vector vector_of(const gsl_vector& values) {
  return Eigen::Map<const Vector, 0, Eigen::InnerStride<>>(
      values.data, static_cast<Index>(values.size),
      Eigen::InnerStride<>(static_cast<Index>(values.stride)));
}
int residual_call(const gsl_vector* theta, void* calls, gsl_vector* r) {
  const Vector at = vector_of(*theta);
  Vector value(static_cast<Index>(r->size));
  const bool is_running = static_cast<ResidualCalls*>(calls)->residual(at.data(), value.data());
  Eigen::Map<Vector, 0, Eigen::InnerStride<>>(
      r->data, value.size(), Eigen::InnerStride<>(static_cast<Index>(r->stride))) = value;
  return answer(is_running);
}
int jacobian_call(const gsl_vector* theta, void* calls, gsl_matrix* J) {
  const Vector at = vector_of(*theta);
  return answer(static_cast<ResidualCalls*>(calls)->jacobian(
      at.data(), [&](const Vector&, const Matrix& value) {
        using RowMajor = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        Eigen::Map<RowMajor, 0, Eigen::OuterStride<>>(
            J->data, value.rows(), value.cols(), Eigen::OuterStride<>(static_cast<Index>(J->tda))) =
            value;
      }));
}

class Gsl final : public Optimizer {
 public:
  explicit Gsl(GslOptions options) : options_(std::move(options)) {
    gsl_set_error_handler_off();  // which would end the process
  }
  void start(Meter&, const Vector&) override {}
  bool reports_iterations() const override { return true; }
  Status step(Meter& f, Vector& theta) override {
    ResidualCalls calls(f, theta);
    const auto m = static_cast<std::size_t>(f.residuals());
    const auto n = static_cast<std::size_t>(f.unknowns());
    gsl_multifit_nlinear_fdf functions{.f = &residual_call,
                                       .df = &jacobian_call,
                                       .fvv = nullptr,  // by a difference of r
                                       .n = m,
                                       .p = n,
                                       .params = &calls,
                                       .nevalf = 0,
                                       .nevaldf = 0,
                                       .nevalfvv = 0};
    const gsl_multifit_nlinear_parameters parameters = parameters_of(options_);
    const std::unique_ptr<gsl_multifit_nlinear_workspace, decltype(&gsl_multifit_nlinear_free)>
        workspace(gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, m, n),
                  &gsl_multifit_nlinear_free);
    require(workspace != nullptr, "GSL has no memory for this problem");
    const gsl_vector_const_view start = gsl_vector_const_view_array(theta.data(), n);
    int test = 0;
    int end = gsl_multifit_nlinear_init(&start.vector, &functions, workspace.get());
    while (end == GSL_SUCCESS && test == 0) {
      end = gsl_multifit_nlinear_iterate(workspace.get());
      if (end != GSL_SUCCESS) break;
      if (!calls.accept()) break;
      gsl_multifit_nlinear_test(options_.xtol, options_.gtol, 0, &test, workspace.get());
    }
    theta = vector_of(*workspace->x);
    const bool is_own_test = end == GSL_SUCCESS && test != 0;
    constexpr const char* kTests[] = {"stopped", "xtol", "gtol"};
    return calls.end(theta, is_own_test ? kTests[test] : gsl_strerror(end),
                     is_own_test ? Status::converged : Status::stalled);
  }

 private:
  const GslOptions options_;
};

}  // namespace

void register_gsl(OptimizerRegistry& registry) {
  registry.add(
      {.name = "gsl-multifit",
       .title = "Trust regions (GSL multifit_nlinear)",
       .family = Family::gsl,
       .kind = Kind::least_squares,
       .formula = "θ ← θ − (JᵀJ + μD²)⁻¹ Jᵀ r,  or min ‖r + J d‖² over ‖D d‖ ≤ Δ",
       .source = "GSL 2.7; Moré (1978), Nielsen (1999), Transtrum, Sethna (2012)",
       .note = std::string("Geodesic acceleration costs one additional forward solve per step. ") +
               kFailedNote,
       .needs = {Oracle::forward, Oracle::jacobian},
       .is_input_scale_invariant = true,
       .needs_same_samples = true,
       .most_unknowns = 4096,
       .most_rank = 1024,
       .options = option_table<GslOptions>(),
       .in_all = false,  // a peer for certified data
       .objection = too_few_residuals,
       .make = [](const OptionValues& options, const OptimizerRegistry&) {
         return std::make_unique<Gsl>(read_options<GslOptions>(options));
       }});
}

}  // namespace isoline::optimizers
