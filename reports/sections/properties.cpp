// The audit of properties: a sentence and a plot each, and the table of all that was measured.
#include <fmt/format.h>

#include <algorithm>
#include <array>
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
  const char* meaning;  // the explanation for a new reader
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
      "it, as the names show. Of two exponents the first is that of the first step, the second "
      "that "
      "of the change of the loss to first order.";
  section.readings = property_readings(all);
  section.tables = {properties_table(all)};
  section.plots = property_plots(all);
  return section;
}

// The results of an audit, one sentence per property, for a new reader.

namespace {

constexpr Real kSame = 0.02;  // how near to a whole exponent is that exponent

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

// Whose first step goes with this exponent of what is scaled.
std::string listed_with(const Audits& all, Scaled scaled, Real exponent) {
  return listed_where(all, [=](const AuditedOptimizer& audited) {
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
  return fmt::format(
      " Newton’s factor is measured where L has a Hessian: if x is rescaled by s, its step goes "
      "as s^{:.2g} and that of gradient descent as s^{:.2g}, which differ by s^{:.2g}.",
      newton, gradient, newton - gradient);
}

// The chapter's L = αx, where the figures and the chapter need not say the same.
std::string slope_sentence(const Audits& all) {
  return fmt::format(
      "For the linear loss L = αx, the book’s chapter states that gradient descent steps by α and "
      "changes "
      "L by α², that the inverse Hessian of Newton’s method brings a factor 1/α², and that the "
      "inverse gradient steps by 1/α. It states no law for Adam, half-inverse gradients or others. "
      "Measured exponents: 1 for {}; 0 for {}; −1 for {}. Other methods than the inverse gradient "
      "with −1 do not contradict the chapter. On L alone, whose Hessian is zero, Newton’s method "
      "has no step. Methods over residuals and inverses use y = αx with a target one below, which "
      "the step 1/α reaches.{}",
      listed_with(all, Scaled::slope, 1), listed_with(all, Scaled::slope, 0),
      listed_with(all, Scaled::slope, -1), hessian_sentence(all));
}

std::string scaling_sentence(const Audits& all) {
  const auto has_none = [](const AuditedOptimizer& audited) {
    const PowerLaw& law = audited.law(Scaled::input).step;
    return law.has_values() && !law.holds();
  };
  return fmt::format(
      "If x is written in a unit s times as large, its values shrink by 1/s, and a step should "
      "shrink by the same factor. Exponent −1, as required: {}. Exponent 1, a small step where a "
      "large one is needed: {}. No power law: {}. {}",
      listed_with(all, Scaled::input, -1), listed_with(all, Scaled::input, 1),
      listed_where(all, has_none), slope_sentence(all));
}

std::string invariance_sentence(const Audits& all) {
  const auto kept = [&](std::size_t first, std::size_t last) {
    return listed_where(all, [=](const AuditedOptimizer& audited) {
      for (std::size_t i = first; i < last; ++i)
        if (!(audited.deviations[i] <= kInvariantDeviation)) return false;
      return true;
    });
  };
  return fmt::format(
      "The path stays the same in other units of each component of x: {}; under every affine "
      "change of x: {}; under every affine change of y: {}.",
      kept(0, 1), kept(0, 3), kept(3, 6));
}

std::string convergence_sentence(const Audits& all) {
  constexpr Real kQuadratic = 1.7;  // rounding leaves few points to fit
  const auto is_at_once = [](const AuditedOptimizer& audited) {
    return audited.regular.is_exact && audited.regular.steps == 1;
  };
  const auto is_quadratic = [](const AuditedOptimizer& audited) {
    return audited.regular.residual <= kMostOrderResidual && audited.regular.order >= kQuadratic;
  };
  const auto arrives = [](const AuditedOptimizer& audited) { return audited.singular.is_exact; };
  return fmt::format(
      "Near a solution, the number of correct digits doubles in each step (order 2): {}. One step "
      "suffices: {}. Others gain digits at a steady rate (order 1) or not at all. Reach a "
      "solution with a singular Jacobian to rounding: {}.",
      listed_where(all, is_quadratic), listed_where(all, is_at_once), listed_where(all, arrives));
}

std::string composition_sentence(const Audits& all) {
  constexpr Real kSmallest = 0.05;  // degrees: what prints as 0.0
  const AuditedOptimizer* worst = nullptr;
  for (const AuditedOptimizer& audited : all)
    if (audited.reason.empty() && audited.linear_angle >= kSmallest &&
        (worst == nullptr || audited.linear_angle > worst->linear_angle))
      worst = &audited;
  return fmt::format(
      "In a composition of stages, the change of an intermediate quantity should equal the step "
      "that the method would take there. Equal through a linear stage: {}. Largest angle between "
      "the two: {}.",
      listed_where(all, [](const AuditedOptimizer& one) { return one.linear_angle < kSmallest; }),
      worst == nullptr ? "none" : fmt::format("{}, {:.0f}°", worst->name, worst->linear_angle));
}

std::string oracle_sentence(const Audits& all) {
  const auto asks = [&](const char* oracle) {
    return listed_where(
        all, [=](const AuditedOptimizer& audited) { return audited.counted.contains(oracle); });
  };
  const auto needs_loss_alone = [](const AuditedOptimizer& audited) {
    return audited.counted.size() == 1 && audited.counted.contains("forward");
  };
  return fmt::format(
      "Counted calls. Only the loss: {}. A Jacobian: {}. A Hessian: {}. An inverse of the "
      "physics: {}. The true x, which a user does not know: {}.",
      listed_where(all, needs_loss_alone), asks("jacobian"), asks("hessian"), asks("inverse"),
      asks("truth"));
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
  if (!teachers.empty())
    unmeasured += fmt::format(
        " {} train a network: the loss and y are scaled, the path is that of the weights, and "
        "changes of x, order and angle do not apply, since there is no step in x.",
        joined(teachers));
  if (text.empty()) text = "Every measured optimizer behaves as it declares";
  return text + "." + unmeasured;
}

}  // namespace

std::vector<Reading> property_readings(const Audits& all) {
  return {{"Scaling", scaling_sentence(all)},         {"Invariance", invariance_sentence(all)},
          {"Convergence", convergence_sentence(all)}, {"Composition", composition_sentence(all)},
          {"Oracles", oracle_sentence(all)},          {"Declarations", declaration_sentence(all)}};
}

// A plot a property: a row an optimizer, a mark what was measured of it.

namespace {

// A series each name: value(its number, optimizer).
template <class Names, class Value>
Plot dots_plot(const Audits& all, const char* id, const char* title, std::array<Real, 2> window,
               const Names& names, Value value) {
  Plot plot{
      .kind = Plot::Kind::dots, .id = id, .title = title, .is_folded = true, .window = window};
  for (const AuditedOptimizer& audited : all)
    plot.rows.push_back({audited.name, {.method = audited.name}});
  for (std::size_t i = 0; i < std::size(names); ++i) {
    PlotSeries& series =
        plot.series.emplace_back(PlotSeries{std::nullopt, std::string(names[i]), {}, {}, {}, {}});
    for (std::size_t row = 0; row < all.size(); ++row) {
      const Real measured = all[row].reason.empty() ? value(i, all[row]) : kUnknown;
      if (std::isnan(measured)) continue;
      series.x.push_back(measured);
      series.y.push_back(Real(row));
    }
  }
  return plot;
}

constexpr std::array kOracles = {"forward", "pullback", "jacobian", "hessian", "inverse", "truth"};

}  // namespace

std::vector<Plot> property_plots(const Audits& all) {
  using Audited = const AuditedOptimizer&;
  const auto exponent = [](std::size_t i, Audited audited) {
    const PowerLaw& law = audited.scalings[i].step;
    return law.holds() ? law.exponent : kUnknown;
  };
  const auto deviation = [](std::size_t i, Audited audited) {
    constexpr Real kLeast = 1e-16;  // as small as rounding lets be told
    const Real value = audited.deviations[i];
    return std::isnan(value) ? value : std::log10(std::max(value, kLeast));
  };
  const auto order = [](std::size_t i, Audited audited) {
    const Approach& approach = i == 0 ? audited.regular : audited.singular;
    return approach.residual <= kMostOrderResidual ? approach.order : kUnknown;
  };
  const auto angle = [](std::size_t i, Audited audited) {
    return i == 0 ? audited.linear_angle : audited.curved_angle;
  };
  const auto calls = [](std::size_t i, Audited audited) {
    const auto at = audited.counted.find(kOracles[i]);
    if (at == audited.counted.end() || audited.iterations == 0) return kUnknown;
    return static_cast<Real>(at->second) / static_cast<Real>(audited.iterations);
  };
  return {dots_plot(all, "plot-exponents", "Exponent of the first step, by what is scaled", {-1, 2},
                    kScalingNames, exponent),
          dots_plot(all, "plot-deviations",
                    "Deviation of the path, decades: −16 is rounding, 0 another path", {-16, 0},
                    kChangeNames, deviation),
          dots_plot(all, "plot-orders", "Order of convergence", {0, 2.5},
                    std::array{"J regular", "J singular"}, order),
          dots_plot(all, "plot-angles",
                    "Angle between the change that was asked and that made, degrees", {0, 90},
                    std::array{"linear stage", "curved stage"}, angle),
          dots_plot(all, "plot-oracles", "Oracle calls an iteration, as counted", {0, 4}, kOracles,
                    calls)};
}

}  // namespace isoline::reports
