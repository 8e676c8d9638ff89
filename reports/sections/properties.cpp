// The audit of properties: one sentence per property, and the table of all measurements.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr const char* kNoLaw = "no power law";
constexpr const char* kNoStep = "no step";
constexpr const char* kNoSense = "does not apply";  // for methods that train a network

// Two decimals, without the minus of a zero.
std::string decimal(Real value) {
  const std::string text = fmt::format("{:.2f}", std::round(100 * value) / 100 + 0.0);
  return text.substr(0, text.find_last_not_of('0') + 1 - (text.ends_with(".00") ? 1 : 0));
}

std::string exponent_text(const PowerLaw& law) {
  if (!law.has_values()) return kNoStep;
  return law.holds() ? decimal(law.exponent) : kNoLaw;
}

std::string deviation_text(Real deviation) {
  if (std::isnan(deviation)) return kNoStep;
  return deviation <= kInvariantDeviation ? "kept" : fmt::format("{:.2g}", deviation);
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

// In the order of the columns.
std::vector<TableCell> properties_row(const AuditedOptimizer& audited) {
  const bool is_teacher = !audited.network.empty();
  std::vector<TableCell> row = {shown_spec(audited.spec)};
  for (const Scaled scaled : {Scaled::loss, Scaled::output, Scaled::input, Scaled::slope}) {
    const ScalingLaw& law = audited.law(scaled);
    const std::string step = exponent_text(law.step), change = exponent_text(law.loss_change);
    row.push_back(is_teacher && law.scales.empty() ? kNoSense
                  : step == change                 ? step
                                                   : step + " / " + change);
  }
  for (const std::size_t first : {0, 3}) {
    const auto& d = audited.deviations;
    std::vector<std::string> parts;
    for (std::size_t i = first; i < first + 3; ++i) parts.push_back(deviation_text(d[i]));
    row.push_back(is_teacher && std::isnan(d[first]) ? kNoSense : joined(parts));
  }
  row.push_back(approach_text(audited, audited.regular));
  row.push_back(approach_text(audited, audited.singular));
  row.push_back(is_teacher
                    ? kNoSense
                    : angle_text(audited.linear_angle) + ", " + angle_text(audited.curved_angle));
  std::vector<std::string> calls;
  for (const auto& [oracle, count] : audited.counted)
    calls.push_back(fmt::format("{} {}", oracle, count));
  row.push_back(fmt::format("{} in {}", joined(calls), audited.iterations));
  row.push_back(joined(audited.flags, "; "));
  return row;
}

Table properties_table(const Audits& all) {
  Table table = worded_table("audit-table");
  table.parts = {4, 2, 3, 2};
  for (const AuditedOptimizer& audited : all) {
    table.rows.push_back(audited.reason.empty()
                             ? properties_row(audited)
                             : std::vector<TableCell>{shown_spec(audited.spec), audited.reason});
    table.row_topics.push_back({.method = audited.name});
  }
  const auto has_flags = [](const AuditedOptimizer& audited) { return !audited.flags.empty(); };
  if (std::ranges::none_of(all, has_flags)) {  // of which a sentence tells
    table.columns.pop_back();
    table.meanings.pop_back();
    table.parts.back() = 1;
    for (auto& row : table.rows)
      if (row.size() > table.columns.size()) row.pop_back();
  }
  return table;
}

}  // namespace

Section properties_section(const Audits& all) {
  Section section = worded_section("audit");
  if (all.empty()) return section;
  section.readings = property_readings(all);
  section.tables = {properties_table(all)};
  return section;
}

// The results of an audit, one sentence per property, for a new reader.

namespace {

using Audited = const AuditedOptimizer&;

template <class Test>
std::vector<std::string> names_where(const Audits& all, Test test) {
  std::vector<std::string> names;
  for (const AuditedOptimizer& audited : all)
    if (audited.reason.empty() && test(audited)) names.push_back(audited.name);
  return names;
}

template <class Test>
std::string listed_where(const Audits& all, Test test) {
  const std::vector<std::string> names = names_where(all, test);
  return names.empty() ? "none" : joined(names);
}

// The methods whose first step has this exponent in the scaled quantity.
std::string listed_with(const Audits& all, Scaled scaled, Real exponent) {
  constexpr Real kSame = 0.02;  // largest distance from a whole exponent
  return listed_where(all, [=](Audited audited) {
    const PowerLaw& law = audited.law(scaled).step;
    return law.holds() && std::abs(law.exponent - exponent) <= kSame;
  });
}

// The factor of the inverse Hessian: a slope has none, but where L is curved and x rescaled by s,
// Newton's step and the gradient's differ by it.
std::string hessian_sentence(const Audits& all) {
  const auto step_of = [&](const char* name) {
    const auto found = std::ranges::find(all, name, &AuditedOptimizer::name);
    return found != all.end() && found->law(Scaled::input).step.holds()
               ? found->law(Scaled::input).step.exponent
               : kUnknown;
  };
  const Real newton = step_of("newton"), gradient = step_of("gd");
  if (std::isnan(newton - gradient)) return "";
  return " " + words("audit.hessian", newton, gradient, newton - gradient);
}

// The results for the chapter's L = αx follow; they may differ from the chapter.
std::string scaling_sentence(const Audits& all) {
  const auto has_none = [](Audited audited) {
    const PowerLaw& law = audited.law(Scaled::input).step;
    return law.has_values() && !law.holds();
  };
  const std::string slope =
      words("audit.slope", listed_with(all, Scaled::slope, 1), listed_with(all, Scaled::slope, 0),
            listed_with(all, Scaled::slope, -1), hessian_sentence(all));
  return words("audit.scaling", listed_with(all, Scaled::input, -1),
               listed_with(all, Scaled::input, 1), listed_where(all, has_none), slope);
}

std::string invariance_sentence(const Audits& all) {
  const auto kept = [&](std::size_t first, std::size_t last) {
    return listed_where(all, [=](Audited audited) {
      return std::all_of(audited.deviations.begin() + std::ptrdiff_t(first),
                         audited.deviations.begin() + std::ptrdiff_t(last),
                         [](Real deviation) { return deviation <= kInvariantDeviation; });
    });
  };
  return words("audit.invariance", kept(0, 1), kept(0, 3), kept(3, 6));
}

std::string convergence_sentence(const Audits& all) {
  constexpr Real kQuadratic = 1.7;  // rounding leaves few points to fit
  const auto is_quadratic = [](Audited audited) {
    return audited.regular.residual <= kMostOrderResidual && audited.regular.order >= kQuadratic;
  };
  const auto is_at_once = [](Audited audited) {
    return audited.regular.is_exact && audited.regular.steps == 1;
  };
  const auto arrives = [](Audited audited) { return audited.singular.is_exact; };
  return words("audit.convergence", listed_where(all, is_quadratic), listed_where(all, is_at_once),
               listed_where(all, arrives));
}

std::string composition_sentence(const Audits& all) {
  constexpr Real kSmallest = 0.05;  // degrees: the largest angle that is printed as 0.0
  const auto is_equal = [](Audited one) { return one.linear_angle < kSmallest; };
  const AuditedOptimizer* worst = nullptr;
  for (const AuditedOptimizer& audited : all)
    if (audited.reason.empty() && audited.linear_angle >= kSmallest &&
        (worst == nullptr || audited.linear_angle > worst->linear_angle))
      worst = &audited;
  return words(
      "audit.composition", listed_where(all, is_equal),
      worst == nullptr ? "none" : fmt::format("{}, {:.0f}°", worst->name, worst->linear_angle));
}

std::string oracle_sentence(const Audits& all) {
  const auto asks = [&](const char* oracle) {
    return listed_where(all, [=](Audited audited) { return audited.counted.contains(oracle); });
  };
  const auto needs_loss_alone = [](Audited audited) {
    return audited.counted.size() == 1 && audited.counted.contains("forward");
  };
  return words("audit.oracles", listed_where(all, needs_loss_alone), asks("jacobian"),
               asks("hessian"), asks("inverse"), asks("truth"));
}

std::string declaration_sentence(const Audits& all) {
  std::string text, unmeasured;
  for (const AuditedOptimizer& audited : all) {
    if (!audited.reason.empty())
      unmeasured += fmt::format(" Not measured: {}, {}.", audited.name, audited.reason);
    for (const std::string& flag : audited.flags)
      text += fmt::format("{}{} {}", text.empty() ? "" : "; ", audited.name, flag);
  }
  const std::vector<std::string> teachers =
      names_where(all, [](const AuditedOptimizer& audited) { return !audited.network.empty(); });
  if (!teachers.empty()) unmeasured += " " + words("audit.teachers", joined(teachers));
  if (text.empty()) text = "Every measured optimizer behaves as it declares";
  return text + "." + unmeasured;
}

}  // namespace

std::vector<Reading> property_readings(const Audits& all) {
  return {{"Scaling", scaling_sentence(all)},         {"Invariance", invariance_sentence(all)},
          {"Convergence", convergence_sentence(all)}, {"Composition", composition_sentence(all)},
          {"Oracles", oracle_sentence(all)},          {"Declarations", declaration_sentence(all)}};
}

}  // namespace isoline::reports
