// Fast transforms of real grids, by FFTW.
#include "core/fourier.h"

#include <fftw3.h>

#include "core/errors.h"
#include "core/threads.h"

namespace isoline {
namespace {

// Plans are estimated, not timed: a timed choice would change the bits from run to run.
constexpr unsigned kFlags = FFTW_ESTIMATE | FFTW_PRESERVE_INPUT;

fftw_complex* entries(auto& spectrum) {
  return reinterpret_cast<fftw_complex*>(spectrum.data());  // the layout FFTW documents
}

// A plan may run on any array aligned like the one it was made for.
bool is_aligned_like(const Real* array, const Vector& planned) {
  return fftw_alignment_of(const_cast<Real*>(array)) ==
         fftw_alignment_of(const_cast<Real*>(planned.data()));
}

// The caller's grid where the plan may read it, our copy of it elsewhere. FFTW takes no pointer to
// const; the plans preserve their input.
Real* readable(VectorRef grid, Vector& copy) {
  require(grid.size() == copy.size(), "the grid does not fit the transform");
  if (is_aligned_like(grid.data(), copy)) return const_cast<Real*>(grid.data());
  copy = grid;
  return copy.data();
}

// Lets `execute` write into the caller's grid where the plan may, through our own elsewhere.
void write(VectorOut grid, Vector& own, auto execute) {
  require(grid.size() == own.size(), "the grid does not fit the transform");
  if (is_aligned_like(grid.data(), own)) return execute(grid.data());
  execute(own.data());
  grid = own;
}

}  // namespace

std::string fourier_version() {
  const std::string version = fftw_version;  // "fftw-3.3.10-sse2-avx"
  const std::size_t begin = version.find('-') + 1;
  return version.substr(begin, version.find('-', begin) - begin);
}

void DestroyPlan::operator()(fftw_plan_s* plan) const { fftw_destroy_plan(plan); }

// FFTW counts dimensions from the slowest: columns first, rows last.
RealFourier2d::RealFourier2d(Index rows, Index columns)
    : spectrum_(rows / 2 + 1, columns), grid_(rows * columns) {
  const int slow = static_cast<int>(columns), fast = static_cast<int>(rows);
  forward_.reset(fftw_plan_dft_r2c_2d(slow, fast, grid_.data(), entries(spectrum_), kFlags));
  inverse_.reset(fftw_plan_dft_c2r_2d(slow, fast, entries(spectrum_), grid_.data(), FFTW_ESTIMATE));
}

void RealFourier2d::forward(VectorRef grid) {
  fftw_execute_dft_r2c(forward_.get(), readable(grid, grid_), entries(spectrum_));
}

void RealFourier2d::inverse(VectorOut grid) {
  write(grid, grid_,
        [this](Real* out) { fftw_execute_dft_c2r(inverse_.get(), entries(spectrum_), out); });
}

SineTransform::SineTransform(Index rows) : odd_(2 * (rows + 1)), half_(rows + 2) {
  const int length = static_cast<int>(odd_.size());
  plan_.reset(fftw_plan_dft_r2c_1d(length, odd_.data(), entries(half_), kFlags));
  odd_.setZero();  // two of its entries stay so: FFTW preserves them
}

void SineTransform::columns(BatchRef grid, BatchOut spectrum) {
  const Index rows = half_.size() - 2;
  require(grid.rows() == rows && spectrum.rows() == rows && spectrum.cols() == grid.cols(),
          "the grid does not fit the transform");
  for (Index j = 0; j < grid.cols(); ++j) {
    odd_.segment(1, rows) = grid.col(j);
    odd_.tail(rows) = -grid.col(j).reverse();
    fftw_execute(plan_.get());
    spectrum.col(j) = -half_.segment(1, rows).imag();
  }
}

}  // namespace isoline
