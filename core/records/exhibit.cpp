// Pictures of an exhibit as arrays of NumPy.
#include "core/records/exhibit.h"

#include <fmt/format.h>

#include "core/errors.h"
#include "core/records/npy.h"

namespace isoline {
namespace {

constexpr Index kPanels = 3;

// A file holds rows of the picture, a field its columns: N×N numbers turned over.
std::vector<Real> turned(const Real* values, Index N) {
  std::vector<Real> turned(static_cast<std::size_t>(N * N));
  for (Index i = 0; i < N; ++i)
    for (Index j = 0; j < N; ++j) turned[static_cast<std::size_t>(i * N + j)] = values[j * N + i];
  return turned;
}

}  // namespace

void write_pictures(const Exhibit& exhibit, const std::string& path) {
  const Index N = exhibit.grid;
  NumberArray array{{kPanels, N, N}, {}};
  for (const Grid* panel : {&exhibit.target, &exhibit.x, &exhibit.truth}) {
    require(static_cast<Index>(panel->values().size()) == N * N, "a picture has the wrong size");
    const std::vector<Real> rows = turned(panel->values().data(), N);
    array.values.insert(array.values.end(), rows.begin(), rows.end());
  }
  write_npy(path, array);
}

void read_pictures(Exhibit& exhibit, const std::string& path) {
  const Index N = exhibit.grid;
  const NumberArray array = read_npy(path);
  require(array.shape == std::vector<Index>{kPanels, N, N},
          [&] { return fmt::format("{} holds no three pictures of {} × {}", path, N, N); });
  const Real* panel = array.values.data();
  for (Grid* out : {&exhibit.target, &exhibit.x, &exhibit.truth}) {
    *out = Grid(N * N, 1, turned(panel, N));
    panel += N * N;
  }
}

}  // namespace isoline
