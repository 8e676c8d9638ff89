// Numbers as text, and the choice of the format by the file's ending.
#include "core/records/number_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "core/errors.h"
#include "core/files.h"

namespace isoline {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) {
    const auto first = cell.find_first_not_of(" \t\r"), last = cell.find_last_not_of(" \t\r");
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

std::optional<Real> number_of(const std::string& cell) {
  Real value = 0;
  const char* end = cell.data() + cell.size();
  const auto [stop, error] = std::from_chars(cell.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

bool is_header(const std::vector<std::string>& cells) {
  return std::ranges::none_of(cells, [](const auto& cell) { return number_of(cell).has_value(); });
}

NumberArray read_csv(const std::filesystem::path& path) {
  std::istringstream in(read_text(path));
  NumberArray array;
  Index rows = 0, columns = 0, number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const std::vector<std::string> cells = cells_of(line);
    if (cells.empty() || (number == 1 && is_header(cells))) continue;
    const auto count = static_cast<Index>(cells.size());
    if (rows == 0) columns = count;
    require(count == columns, [&] {
      return fmt::format("{}: line {} has {} numbers, the first has {}", path.string(), number,
                         count, columns);
    });
    for (const std::string& cell : cells) {
      const std::optional<Real> value = number_of(cell);
      require(value && std::isfinite(*value), [&] {
        return fmt::format("{}: line {}: '{}' is no finite number", path.string(), number, cell);
      });
      array.values.push_back(*value);
    }
    ++rows;
  }
  array.shape = {rows, columns};
  return array;
}

void write_csv(const std::filesystem::path& path, const NumberArray& array) {
  const std::size_t rows = static_cast<std::size_t>(array.shape.at(0));
  const std::size_t columns = rows > 0 ? array.values.size() / rows : 0;
  std::string text;
  for (std::size_t row = 0; row < rows; ++row) {
    const auto first = array.values.begin() + static_cast<std::ptrdiff_t>(row * columns);
    text +=
        fmt::format("{}\n", fmt::join(first, first + static_cast<std::ptrdiff_t>(columns), ","));
  }
  write_text(path, text);
}

void require_known(const std::filesystem::path& path) {
  require(path.extension() == ".npy" || path.extension() == ".csv", [&] {
    return fmt::format("{}: arrays are read and written as .npy or .csv", path.string());
  });
}

}  // namespace

NumberArray read_numbers(const std::filesystem::path& path) {
  require_known(path);
  return path.extension() == ".npy" ? read_npy(path) : read_csv(path);
}

void write_numbers(const std::filesystem::path& path, const NumberArray& array) {
  require_known(path);
  path.extension() == ".npy" ? write_npy(path, array) : write_csv(path, array);
}

}  // namespace isoline
