// Grids of tuning: which option of a method, around which value, in which unit.
#include "benchmarks/run/tuning_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "benchmarks/run/isolate.h"
#include "core/json.h"

namespace isoline::benchmarks {

using optimizers::Tunable;
namespace {

constexpr double kUnitSeconds = 30;
constexpr const char* kNested = "network-optimizer";

const OptionField* field_of(const OptimizerEntry& entry, const std::string& option) {
  const auto at = std::ranges::find(entry.options, option, &OptionField::name);
  return at == entry.options.end() ? nullptr : &*at;
}

Real number_of(const OptionValue& value) {
  if (const Index* whole = std::get_if<Index>(&value)) return static_cast<Real>(*whole);
  const Real* number = std::get_if<Real>(&value);
  return number ? *number : 1;
}

Knob knob_of_field(const OptimizerEntry& entry, const OptionField& field) {
  return {.option = field.name,
          .standard = number_of(field.standard),
          .range = field.range,
          .is_whole = std::holds_alternative<Index>(field.standard),
          .tunable = entry.tunable};
}

// The rate of the gradient rule inside: what is given, or what network-optimizer=auto stands for.
Knob knob_inside(const Catalog& catalog, const OptimizerEntry& outer, const Component& problem,
                 const OptionValues& given) {
  const Spec inner = parse_spec(given.text(kNested, "auto"));
  const bool is_automatic = inner.name == "auto";
  const std::string rule = !is_automatic ? inner.name : problem.is_learned ? "adam" : "gd";
  const OptimizerEntry& entry = catalog.optimizers.at(rule);
  const OptionField* field = field_of(entry, "rate");
  require(field != nullptr, [&] { return fmt::format("{} has no rate to be tuned", rule); });
  Knob knob = knob_of_field(entry, *field);
  knob.rule = rule;
  const OptionValues options = options_of(inner);
  if (options.contains("rate")) knob.standard = std::stod(options.text("rate"));
  if (is_automatic && !problem.is_learned) {  // gd[rate=1]: a unit of its own, not the loss's
    knob.standard = 1;
    knob.tunable = outer.tunable;
  }
  return knob;
}

std::optional<Real> allowed(const Knob& knob, Real value) {
  value = knob.is_whole ? std::round(value) : three_digits(value);
  return value > 0 && contains(knob.range, value) ? std::optional(value) : std::nullopt;
}

Real measured_cauchy_step(const Problem& problem) {
  Point point;
  problem.forward(problem.start(), point);
  Matrix g(problem.outputs(), problem.samples()), pushed(problem.outputs(), problem.samples());
  Matrix curved(problem.outputs(), problem.samples());
  Vector gradient(problem.unknowns());
  problem.cotangent(point, g);
  problem.pullback(g, gradient, point);
  problem.pushforward(gradient, pushed, point);
  problem.loss_curvature(point, pushed, curved);
  return gradient.squaredNorm() / pushed.cwiseProduct(curved).sum();
}

}  // namespace

std::optional<Knob> knob_of(const Catalog& catalog, const std::string& optimizer,
                            const Component& problem, const OptionValues& given) {
  const OptimizerEntry& entry = catalog.optimizers.at(optimizer);
  const Tunable& tunable = entry.tunable;
  if (tunable.option.empty()) return std::nullopt;
  const bool trains = problem.is_learned && field_of(entry, kNested);
  if (trains || tunable.option == kNested) return knob_inside(catalog, entry, problem, given);
  return knob_named(catalog, optimizer, problem, given, tunable.option);
}

Knob knob_named(const Catalog& catalog, const std::string& optimizer, const Component& problem,
                const OptionValues& given, const std::string& option) {
  const OptimizerEntry& entry = catalog.optimizers.at(optimizer);
  const OptionField* field = field_of(entry, option);
  if (!field && option == "rate" && field_of(entry, kNested))
    return knob_inside(catalog, entry, problem, given);
  const bool is_number = field && !std::holds_alternative<bool>(field->standard) &&
                         !std::holds_alternative<std::string>(field->standard);
  require(is_number, [&] { return fmt::format("{} has no number {} to tune", optimizer, option); });
  Knob knob = knob_of_field(entry, *field);
  knob.standard = given.number(option, knob.standard);
  return knob;
}

OptionValues with_value(const Knob& knob, OptionValues given, Real value) {
  if (knob.is_whole)
    given.set(knob.option, static_cast<Index>(std::round(value)));
  else if (knob.rule.empty())
    given.set(knob.option, value);
  else
    given.set(kNested, fmt::format("{}[{}={}]", knob.rule, knob.option, value));
  return given;
}

Real cauchy_step(const Catalog& catalog, const Component& problem) {
  const auto measured = [&] {
    return json_text(json_number(measured_cauchy_step(make_problem(catalog, problem, 0))));
  };
  const auto text = isolated_text(measured, kUnitSeconds).text;
  const Real step = text ? real_of(parse_json(*text, "Cauchy step")) : 1;
  return std::isfinite(step) && step > 0 ? step : 1;
}

std::vector<Real> grid_of(const Knob& knob, Real unit) {
  std::vector<Real> values;
  for (int i = 0; i < kGridValues; ++i) {
    const Real value = unit * std::pow(knob.tunable.factor, i - knob.tunable.below);
    if (const auto each = allowed(knob, value)) values.push_back(*each);
  }
  if (values.empty()) return {knob.standard};
  if (knob.standard < values.front() || knob.standard > values.back()) return values;
  *std::ranges::min_element(values, {}, [&](Real value) {
    return std::abs(std::log(value / knob.standard));
  }) = knob.standard;
  return values;
}

std::optional<Real> value_beyond(const Knob& knob, const std::vector<Real>& values, bool upward) {
  const Real two = std::pow(knob.tunable.factor, 2);  // from the last but one: less is rounded
  const std::size_t next = values.size() > 1 ? 1 : 0;
  const Real value = upward ? values[values.size() - 1 - next] * two : values[next] / two;
  const auto each = allowed(knob, value);
  return each && *each != values.front() && *each != values.back() ? each : std::nullopt;
}

Real three_digits(Real value) {
  Real result = 0;
  const std::string text = fmt::format("{:.3g}", value);
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

std::vector<Real> values_of(const Knob& knob, const GivenGrid& grid, Real unit) {
  std::vector<Real> values;
  for (const Real each : grid.values)
    values.push_back(knob.is_whole ? std::round(unit * each) : three_digits(unit * each));
  return values;
}

GivenGrid parse_grid(const std::string& text, const std::string& unit) {
  const auto equals = text.find('='), dots = text.find(".."), cross = text.rfind('x');
  Real low = 0, high = 0;
  int count = 0;
  const auto number = [&](std::size_t from, std::size_t to, auto& value) {
    if (to == std::string::npos || from > to) return false;
    return std::from_chars(text.data() + from, text.data() + to, value).ptr == text.data() + to;
  };
  const bool is_read = equals != std::string::npos && number(equals + 1, dots, low) &&
                       number(dots + 2, cross, high) && number(cross + 1, text.size(), count);
  constexpr int kMost = 1000;
  const bool is_grid = is_read && low > 0 && high >= low && std::isfinite(high) && count >= 1;
  require(is_grid,
          [&] { return fmt::format("expected a grid such as rate=1e-4..1e-1x4, got '{}'", text); });
  require(count <= kMost,
          [&] { return fmt::format("a grid has at most 1,000 values, got '{}'", text); });
  GivenGrid grid{.option = text.substr(0, equals), .values = {}, .unit = unit};
  for (int i = 0; i < count; ++i)
    grid.values.push_back(low * std::pow(high / low, count > 1 ? Real(i) / (count - 1) : 0));
  return grid;
}

}  // namespace isoline::benchmarks
