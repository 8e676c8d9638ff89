// Finds the columns of a foreign curve and reads them row by row.
#include "benchmarks/import/foreign_curve.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "benchmarks/import/csv_rows.h"
#include "core/errors.h"

namespace isoline::benchmarks {
namespace {

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
constexpr Real kMostCount = 9007199254740992.0;  // 2^53: above it doubles skip whole numbers

std::optional<Real> number_in(std::string_view field) {
  if (field.starts_with('+')) field.remove_prefix(1);
  Real value = 0;
  const char* end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(field.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

bool is_header(const std::vector<std::string>& fields) {
  return std::ranges::none_of(fields,
                              [](const auto& field) { return number_in(field).has_value(); });
}

// The place of each quantity in a row, from 0.
using Places = std::map<std::string, std::size_t>;

class Reader {
 public:
  Reader(const std::string& text, const std::string& origin, const CurveDescription& told)
      : rows_(text, origin), origin_(origin), told_(told) {}

  ForeignCurve read() {
    std::vector<std::string> fields;
    bool is_any = rows_.next(fields);
    require(is_any, [&] { return fmt::format("{}: it is empty", origin_); });
    columns_ = fields.size();
    const bool has_header = is_header(fields);
    find_places(fields, has_header);
    if (has_header) is_any = rows_.next(fields);
    for (; is_any; is_any = rows_.next(fields)) add(fields);
    require(curve_.points() > 0,
            [&] { return fmt::format("{}: it holds no row of numbers", origin_); });
    return std::move(curve_);
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw UsageError(fmt::format("{}: line {}: {}", origin_, rows_.line(), why));
  }

  void find_places(const std::vector<std::string>& first, bool has_header) {
    for (const auto& [quantity, column] : told_.columns) {
      if (const auto* place = std::get_if<std::int64_t>(&column)) {
        if (static_cast<std::size_t>(*place) > columns_)
          refuse(fmt::format("{} should stand in column {}, and there are {}", quantity, *place,
                             columns_));
        places_[quantity] = static_cast<std::size_t>(*place) - 1;
        continue;
      }
      const std::string& name = std::get<std::string>(column);
      if (!has_header)
        refuse(fmt::format(
            "there is no line of names to find '{}' in: name the column of {} by its place", name,
            quantity));
      const auto count = std::ranges::count(first, name);
      if (count != 1)
        refuse(count > 1
                   ? fmt::format("two columns are named '{}'", name)
                   : fmt::format("no column is named '{}': there are {}", name, names(first)));
      places_[quantity] = static_cast<std::size_t>(std::ranges::find(first, name) - first.begin());
    }
  }

  static std::string names(const std::vector<std::string>& first) {
    constexpr std::size_t kTold = 12;
    const std::vector<std::string> some(
        first.begin(), first.begin() + static_cast<std::ptrdiff_t>(std::min(first.size(), kTold)));
    return fmt::format("{}{}", fmt::join(some, ", "), first.size() > kTold ? ", …" : "");
  }

  void add(const std::vector<std::string>& fields) {
    if (fields.size() != columns_)
      refuse(fmt::format("it has {} fields, and the first line has {}", fields.size(), columns_));
    const auto row = static_cast<std::int64_t>(curve_.points());
    add_count(curve_.iteration, "iteration", fields, row);
    if (row > 0 && curve_.iteration[row] == curve_.iteration[row - 1])
      refuse(fmt::format("iteration {} stands there twice", curve_.iteration[row]));
    std::int64_t work = 0;
    for (const OracleRow& oracle : kOracleTable) {
      const std::string name(oracle.name);
      if (!places_.contains(name)) continue;
      add_count(curve_.counts[name], name, fields, 0);
      if (has_plain_price(oracle.kind)) work += oracle.price({}) * curve_.counts[name].back();
    }
    add_count(curve_.work, "work", fields, work);
    add_time(curve_.wall_seconds, "wall_seconds", fields);
    add_time(curve_.processor_seconds, "processor_seconds", fields);
    const Real unknown = std::nan("");
    curve_.x_error.push_back(real("x_error", fields, unknown));
    curve_.gradient_norm.push_back(real("gradient_norm", fields, unknown));
    curve_.step_norm.push_back(real("step_norm", fields, unknown));
    if (fields[places_.at("loss")].empty()) refuse("loss is missing");
    curve_.loss.push_back(real("loss", fields, unknown));
  }

  // Where the field is empty, or there is no column, it is what is given.
  Real real(const char* quantity, const std::vector<std::string>& fields, Real otherwise) const {
    const auto place = places_.find(quantity);
    if (place == places_.end() || fields[place->second].empty()) return otherwise;
    const std::optional<Real> value = number_in(fields[place->second]);
    if (!value) refuse(fmt::format("{} is no number: '{:.40}'", quantity, fields[place->second]));
    return *value;
  }

  void add_count(std::vector<std::int64_t>& column, const std::string& quantity,
                 const std::vector<std::string>& fields, std::int64_t otherwise) const {
    const auto place = places_.find(quantity);
    if (place == places_.end()) return column.push_back(otherwise);
    const std::optional<Real> value = number_in(fields[place->second]);
    if (!value || !(*value >= 0 && *value <= kMostCount) || *value != std::floor(*value))
      refuse(fmt::format("{} must be a whole number from 0, got '{:.40}'", quantity,
                         fields[place->second]));
    column.push_back(static_cast<std::int64_t>(*value));
    const std::size_t last = column.size() - 1;
    if (last > 0 && column[last] < column[last - 1])
      refuse(fmt::format("{} falls from {} to {}", quantity, column[last - 1], column[last]));
  }

  void add_time(std::vector<Real>& column, const char* quantity,
                const std::vector<std::string>& fields) const {
    const Real value = real(quantity, fields, kInfinity);
    if (!(value >= 0)) refuse(fmt::format("{} must be at least 0, got {}", quantity, value));
    if (!column.empty() && value < column.back())
      refuse(fmt::format("{} falls from {} to {}", quantity, column.back(), value));
    column.push_back(value);
  }

  CsvRows rows_;
  std::string origin_;
  const CurveDescription& told_;
  std::size_t columns_ = 0;
  Places places_;
  ForeignCurve curve_;
};

}  // namespace

ForeignCurve curve_from_text(const std::string& text, const std::string& origin,
                             const CurveDescription& told) {
  return Reader(text, origin, told).read();
}

}  // namespace isoline::benchmarks
