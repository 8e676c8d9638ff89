// Exhibits as JSON where they are small, as arrays of NumPy where they are pictures.
#include "core/records/exhibit.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/npy.h"

namespace isoline {
namespace {

constexpr Index kPanels = 3;

Json to_json(const Matrix& matrix) {
  Json columns = Json::array();
  for (Index b = 0; b < matrix.cols(); ++b)
    columns.push_back(json_numbers(matrix.col(b).data(), static_cast<std::size_t>(matrix.rows())));
  return columns;
}

Matrix matrix_from(const Json& columns) {
  Matrix matrix(columns.empty() ? 0 : columns[0].size(), columns.size());
  for (Index b = 0; b < matrix.cols(); ++b) {
    const Json& column = columns[static_cast<std::size_t>(b)];
    for (Index i = 0; i < matrix.rows(); ++i)
      matrix(i, b) = real_of(column.at(static_cast<std::size_t>(i)));
  }
  return matrix;
}

// A file holds rows of the picture, a field its columns.
Matrix turned(const Real* values, Index N) {
  return Eigen::Map<const Matrix>(values, N, N).transpose().reshaped();
}

}  // namespace

Json to_json(const Exhibit& exhibit) {
  if (exhibit.is_picture()) return {{"grid", exhibit.grid}};
  return {{"grid", 0},
          {"target", to_json(exhibit.target)},
          {"x", to_json(exhibit.x)},
          {"truth", to_json(exhibit.truth)}};
}

Exhibit exhibit_from_json(const Json& json) {
  const Index grid = json.at("grid");
  if (grid > 0) return {.grid = grid, .target = {}, .x = {}, .truth = {}};
  return {.grid = 0,
          .target = matrix_from(json.at("target")),
          .x = matrix_from(json.at("x")),
          .truth = matrix_from(json.at("truth"))};
}

void write_pictures(const Exhibit& exhibit, const std::filesystem::path& path) {
  const Index N = exhibit.grid;
  NumberArray array{{kPanels, N, N}, {}};
  for (const Matrix* panel : {&exhibit.target, &exhibit.x, &exhibit.truth}) {
    const Matrix rows = turned(panel->data(), N);
    array.values.insert(array.values.end(), rows.data(), rows.data() + rows.size());
  }
  write_npy(path, array);
}

void read_pictures(Exhibit& exhibit, const std::filesystem::path& path) {
  const Index N = exhibit.grid;
  const NumberArray array = read_npy(path);
  require(array.shape == std::vector<Index>{kPanels, N, N}, [&] {
    return fmt::format("{} holds no three pictures of {} × {}", path.string(), N, N);
  });
  const Real* panel = array.values.data();
  for (Matrix* out : {&exhibit.target, &exhibit.x, &exhibit.truth}) {
    *out = turned(panel, N);
    panel += N * N;
  }
}

}  // namespace isoline
