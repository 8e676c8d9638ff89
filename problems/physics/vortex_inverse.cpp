// Translation and vortex, estimated.
#include "problems/physics/vortex_inverse.h"

#include <cmath>

#include "problems/physics/flow_samples.h"

namespace isoline::problems {
namespace {

using Point2 = Eigen::Vector2d;

Real cross(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }

const Point2 kMiddle(kFlowMiddle, kFlowMiddle);

}  // namespace

Real VortexInverse::missing_strength(const Point2& c0, const Point2& cT) const {
  constexpr Real kGain = 1e-3;
  const auto centre = [this](const FlowRun& run, Index n) {
    return centre_of_mass(N_, run.marker(n));
  };
  const Real last = static_cast<Real>(steps_), unit = track_ == Track::published ? time_ : last;
  const Point2 end = kMiddle + (kMiddle - c0);
  Real sum = cross(centre(forward_, steps_) - cT, cT - end);
  for (Index i = 0; i < steps_; ++i) {
    const Index n = steps_ - 1 - i;
    const Point2 on_track = kMiddle + (kMiddle - c0) * (static_cast<Real>(n) / unit);
    const Point2 returned = centre(back_, i + 1);
    sum += cross(centre(forward_, n) - returned, returned - on_track);
  }
  return kGain * sum / (last + 1);
}

bool VortexInverse::invert(Simulation& flow, VectorRef x0, VectorRef first, VectorRef last,
                           VectorOut x) {
  flow.begin(x0, first, forward_);
  flow.forward(forward_);
  flow.reverse(forward_, last, back_);
  const Point2 c0 = centre_of_mass(N_, first), cT = centre_of_mass(N_, last);
  const Real strength = vortex_strength(N_, x0) + missing_strength(c0, cT);
  if (!std::isfinite(strength) || !is_finite(c0)) {
    x = x0;
    return false;
  }
  for (const Index axis : {0, 1})
    x.segment(axis * N_ * N_, N_ * N_).setConstant((kFlowMiddle - c0[axis]) / time_);
  add_vortex(N_, strength, x);
  return true;
}

}  // namespace isoline::problems
