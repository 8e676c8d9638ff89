// The audit of properties: a sentence and a plot each, and the table of all that was measured.
#include "reports/sections/properties.h"

#include <fmt/format.h>

#include <cmath>

#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr const char* kNoLaw = "no power law";
constexpr const char* kNoStep = "no step";
constexpr const char* kNoSense = "does not apply";  // to what teaches a network

// Two decimals, without the minus of a zero.
std::string decimal(Real value) {
  const std::string text = fmt::format("{:.2f}", std::round(100 * value) / 100 + 0.0);
  return text.substr(0, text.find_last_not_of('0') + 1 - (text.ends_with(".00") ? 1 : 0));
}

std::string exponent_text(const PowerLaw& law) {
  if (!law.has_values()) return kNoStep;
  return law.holds() ? decimal(law.exponent) : kNoLaw;
}

std::string law_cell(const ScalingLaw& law) {
  const std::string step = exponent_text(law.step), change = exponent_text(law.loss_change);
  return step == change ? step : step + " / " + change;
}

template <Scaled scaled>
std::string law_of(const AuditedOptimizer& audited) {
  const ScalingLaw& law = audited.law(scaled);
  if (!audited.network.empty() && law.scales.empty()) return kNoSense;
  return law_cell(law);
}

std::string deviation_text(Real deviation) {
  if (std::isnan(deviation)) return kNoStep;
  return deviation <= kInvariantDeviation ? "kept" : fmt::format("{:.2g}", deviation);
}

template <std::size_t first>
std::string invariance_cell(const AuditedOptimizer& audited) {
  const auto& d = audited.deviations;
  if (!audited.network.empty() && std::isnan(d[first])) return kNoSense;
  return fmt::format("{}, {}, {}", deviation_text(d[first]), deviation_text(d[first + 1]),
                     deviation_text(d[first + 2]));
}

std::string approach_text(const AuditedOptimizer& audited, const Approach& approach) {
  if (!audited.network.empty()) return kNoSense;
  if (std::isnan(approach.remaining)) return kNoStep;
  if (approach.is_exact && approach.steps == 1) return "one step";
  std::string text = "no order";
  if (approach.residual <= kMostOrderResidual) text = fmt::format("{:.1f}", approach.order);
  if (approach.is_exact) return fmt::format("{} in {}", text, approach.steps);
  return fmt::format("{}, {:.2g} left of {}", text, approach.remaining, approach.steps);
}

std::string angle_text(Real angle) {
  return std::isnan(angle) ? kNoStep : fmt::format("{:.1f}°", angle);
}

std::string asked_cell(const AuditedOptimizer& audited) {
  std::string text;
  for (const auto& [oracle, count] : audited.counted)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", oracle, count);
  return fmt::format("{} in {}", text, audited.iterations);
}

std::string flags_cell(const AuditedOptimizer& audited) { return joined(audited.flags, "; "); }

struct Property {
  const char* heading;
  const char* meaning;  // for a reader who meets it first
  std::string (*cell)(const AuditedOptimizer&);
};

const std::vector<Property> kProperties = {
    {"L → cL", "exponent in c of the first step, and of the loss change ∇Lᵀ Δx",
     law_of<Scaled::loss>},
    {"y → sy", "exponents in s, the target rescaled too", law_of<Scaled::output>},
    {"x = s x'", "exponents in s of the step measured in x'; −1 keeps the step the same in x",
     law_of<Scaled::input>},
    {"L = αx", "exponents in α, the target one below y", law_of<Scaled::slope>},
    {"path under changes of x",
     "diagonal, rotated, affine: kept, or its largest deviation relative to its extent",
     invariance_cell<0>},
    {"path under changes of y", "the same for y", invariance_cell<3>},
    {"order at x*",
     "order of convergence where J is regular at the solution, and steps to rounding",
     [](const AuditedOptimizer& audited) { return approach_text(audited, audited.regular); }},
    {"order, J singular", "the same where J is singular at the solution",
     [](const AuditedOptimizer& audited) { return approach_text(audited, audited.singular); }},
    {"angle",
     "between the change of an intermediate quantity that was asked and the change that was made, "
     "through a linear stage and through a curved one",
     [](const AuditedOptimizer& audited) {
       if (!audited.network.empty()) return std::string(kNoSense);
       return angle_text(audited.linear_angle) + ", " + angle_text(audited.curved_angle);
     }},
    {"asked", "calls of each oracle, as counted over the iterations that are named", asked_cell},
    {"declared otherwise", "what the method declares and the measurement contradicts", flags_cell}};

Table properties_table(const Audits& all) {
  Table table{.id = "audit-table",
              .columns = {"optimizer"},
              .meanings = {""},
              .align = std::string(kProperties.size() + 1, 'l'),
              .parts = {4, 2, 3, 2}};
  for (const Property& property : kProperties) {
    table.columns.emplace_back(property.heading);
    table.meanings.emplace_back(property.meaning);
  }
  for (const AuditedOptimizer& audited : all) {
    std::vector<TableCell> row = {shown_spec(audited.spec)};
    if (!audited.reason.empty()) row.push_back(audited.reason);
    if (audited.reason.empty())
      for (const Property& property : kProperties) row.push_back(property.cell(audited));
    table.rows.push_back(std::move(row));
    table.row_topics.push_back({.method = audited.name});
  }
  return table;
}

}  // namespace

Section properties_section(const Audits& all) {
  Section section{.id = "audit",
                  .title = "Properties, measured",
                  .otherwise = "These results hold no audit of properties."};
  if (all.empty()) return section;
  section.lead =
      "Measured at default options, except that epsilon and cutoff are 0 where the method allows "
      "it, as the names show. Of two exponents the first is that of the first step, the second that "
      "of the change of the loss to first order.";
  section.readings = property_readings(all);
  section.tables = {properties_table(all)};
  section.plots = property_plots(all);
  return section;
}

}  // namespace isoline::reports
