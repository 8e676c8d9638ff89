// What a run keeps of its way, off the clock: its curve, its path, its fields, the spectrum of J,
// and samples of what was learned.
#include <algorithm>
#include <cmath>

#include "core/decompose.h"
#include "core/frames.h"
#include "core/ladder.h"
#include "optimizers/meter.h"

namespace isoline::optimizers {
namespace {

constexpr Index kMostNumbers = Index{1} << 26;  // of J: half a gibibyte

// Whether its J is formed, and small enough.
bool has_spectrum(const Problem& problem) {
  const Index rows = problem.residuals(), columns = problem.unknowns();
  return problem.offers().contains(Oracle::jacobian) &&
         std::min(rows, columns) <= Trace::Spectra::kValues && rows * columns <= kMostNumbers;
}

}  // namespace

void Meter::open_pictures() {
  const auto& field = problem_.field();
  if (!field) return;
  const Picture target(judging().target, field);
  const Picture truth(judging().truth, field, problem_.history());
  open_frames(trace_.frames, field->rows, field->columns, target.cells(), truth.cells());
}

void Meter::keep_point() {
  const int index = trace_.points;
  if (index >= Trace::kPoints) return;
  trace_.point[index] = trace_.last;
  if (trace_.path_inputs > 0) {
    std::copy_n(judged_.x().data(), judged_.x().size(), trace_.path_x[index]);
    std::copy_n(judged_.y.data(), judged_.y.size(), trace_.path_y[index]);
  }
  if (problem_.field())
    keep_frame(trace_.frames, iteration_,
               Picture(judged_.x(), problem_.field(), problem_.history()).cells());
  trace_.points = index + 1;
  trace_.best_loss = best_loss_;
  next_kept_ = next_kept_after(iteration_);
  keep_spectrum(false);
}

// The validation as it was last judged: its first small samples.
void Meter::show() {
  constexpr Index kMostSamples = 256;
  const auto keep = [&](const Matrix& all, Trace::Exhibit& shown) {
    if (all.size() == 0 || all.rows() > Trace::kExhibit) return;
    const Index most = std::min(kMostSamples, Trace::kExhibit / all.rows());
    shown.columns = static_cast<int>(std::min(most, all.cols()));
    std::copy_n(all.data(), all.rows() * shown.columns, shown.value);
    shown.rows = static_cast<int>(all.rows());
  };
  keep(validation_.target, trace_.shown_target);
  keep(judged_.x(), trace_.shown_x);
  keep(validation_.truth, trace_.shown_truth);
}

// At iterations 0, 1, 2, 4, 8, …, or the first kept one after each, and the last.
bool Meter::is_spectrum_due(bool is_last) const {
  const Trace::Spectra& kept = trace_.spectra;
  if (!kept.are_wanted || kept.taken == Trace::Spectra::kPlaces) return false;
  if (kept.taken == 0) return true;
  const std::int64_t last = kept.iteration[kept.taken - 1];
  return is_last ? iteration_ > last : iteration_ >= std::max<std::int64_t>(1, 2 * last);
}

// Over the batch of the step that led here. A J that is not finite has no spectrum.
void Meter::keep_spectrum(bool is_last) {
  if (!is_spectrum_due(is_last) || !has_spectrum(problem_)) return;
  Point point;
  Matrix J;  // (m·B, n)
  Vector sigma;
  problem_.forward(judged_theta_, *samples_, point);
  problem_.jacobian(J, point);
  if (!singular_values(J, sigma)) return;
  Trace::Spectra& kept = trace_.spectra;
  kept.values = static_cast<int>(sigma.size());
  std::copy_n(sigma.data(), sigma.size(), kept.sigma[kept.taken]);
  kept.iteration[kept.taken] = iteration_;
  ++kept.taken;
}

}  // namespace isoline::optimizers
