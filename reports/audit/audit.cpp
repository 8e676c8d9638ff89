// The audit as a table: what each cell says, and how each format lays it out.
#include "reports/audit/audit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "core/json.h"
#include "reports/text.h"

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

std::string flags_cell(const AuditedOptimizer& audited) {
  return fmt::format("{}", fmt::join(audited.flags, "; "));
}

std::string latex_part(const char* caption, const std::vector<std::size_t>& columns,
                       std::span<const AuditedOptimizer> rows) {
  std::string text = fmt::format(
      "\\begin{{table}}[p]\n  \\centering\n  \\footnotesize\n  \\caption{{{}}}\n"
      "  \\begin{{tabular}}{{l{}}}\n    \\toprule\n    optimizer",
      caption, std::string(columns.size(), 'l'));
  for (const std::size_t column : columns)
    text += " & " + latex_text(kAuditColumns[column].heading);
  text += " \\\\\n    \\midrule\n";
  for (const AuditedOptimizer& audited : rows) {
    text += "    " + latex_text(audited.spec);
    if (!audited.reason.empty())
      text += fmt::format(" & \\multicolumn{{{}}}{{l}}{{{}}}", columns.size(),
                          latex_text(audited.reason));
    if (audited.reason.empty())
      for (const std::size_t column : columns)
        text += " & " + latex_text(kAuditColumns[column].cell(audited));
    text += " \\\\\n";
  }
  return text + "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n\n";
}

// Characters, not bytes: what a column of a terminal holds.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char letter) { return (static_cast<unsigned char>(letter) & 0xC0) != 0x80; }));
}

}  // namespace

const std::vector<AuditColumn> kAuditColumns = {
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
     "between the step a stage was promised and the step it made: a linear stage, a curved one",
     [](const AuditedOptimizer& audited) {
       if (!audited.network.empty()) return std::string(kNoSense);
       return angle_text(audited.linear_angle) + ", " + angle_text(audited.curved_angle);
     }},
    {"asked", "calls of each oracle, counted, in so many iterations", asked_cell},
    {"declared otherwise", "what it declares and was measured to be false", flags_cell}};

std::string audit_markdown(const std::vector<AuditedOptimizer>& all) {
  if (all.empty()) return "";
  std::string text = "\n## Properties, measured\n\n", head = "| optimizer |", rule = "|---|";
  for (const AuditReading& reading : audit_readings(all))
    text += fmt::format("- **{}.** {}\n", reading.property, markdown_text(reading.sentence));
  for (const AuditColumn& column : kAuditColumns) {
    head += fmt::format(" {} |", markdown_text(column.heading));
    rule += "---|";
  }
  text += "\n" + head + "\n" + rule + "\n";
  for (const AuditedOptimizer& audited : all) {
    text += fmt::format("| {} |", markdown_text(audited.spec));
    if (!audited.reason.empty()) text += fmt::format(" {} |", markdown_text(audited.reason));
    if (audited.reason.empty())
      for (const AuditColumn& column : kAuditColumns)
        text += fmt::format(" {} |", markdown_text(column.cell(audited)));
    text += "\n";
  }
  text += "\n";
  for (const AuditColumn& column : kAuditColumns)
    text += fmt::format("{}: {}. ", markdown_text(column.heading), markdown_text(column.meaning));
  return text + "\n";
}

// In four tables, so that none is wider than a page.
std::string audit_latex(const std::vector<AuditedOptimizer>& all) {
  struct Part {
    const char* caption;
    std::vector<std::size_t> columns;
  };
  const std::vector<Part> kParts = {
      {"Exponents of the first step, and of the loss change to first order, as measured.",
       {0, 1, 2, 3}},
      {"Deviation of the path under changes of coordinates, diagonal, rotated and affine.", {4, 5}},
      {"Order of convergence, and angle between the step promised to a stage and the step made.",
       {6, 7, 8}},
      {"Calls of each oracle, as counted, and what was declared otherwise.", {9, 10}}};
  constexpr std::size_t kMostRows = 45;
  std::string text;
  for (const Part& part : kParts)
    for (std::size_t first = 0; first < all.size(); first += kMostRows)
      text += latex_part(part.caption, part.columns,
                         std::span(all).subspan(first, std::min(kMostRows, all.size() - first)));
  return text;
}

Json audit_json(const std::vector<AuditedOptimizer>& all) {
  Json json = audit_to_json(all);
  json["readings"] = Json::array();
  for (const AuditReading& reading :
       all.empty() ? std::vector<AuditReading>{} : audit_readings(all))
    json["readings"].push_back({{"property", reading.property}, {"sentence", reading.sentence}});
  return json;
}

// In four blocks, so that none is wider than a terminal.
std::string audit_terminal(const std::vector<AuditedOptimizer>& all) {
  constexpr std::size_t kGap = 2;
  const std::vector<std::vector<std::size_t>> kBlocks = {{0, 1, 2, 3}, {4, 5}, {6, 7, 8}, {9, 10}};
  std::string text;
  for (const auto& block : kBlocks) {
    std::vector<std::vector<std::string>> lines{{"optimizer"}};
    for (const std::size_t column : block) lines[0].emplace_back(kAuditColumns[column].heading);
    for (const AuditedOptimizer& audited : all) {
      lines.push_back({terminal_text(audited.spec)});
      for (const std::size_t column : block)
        if (audited.reason.empty())
          lines.back().push_back(terminal_text(kAuditColumns[column].cell(audited)));
      if (!audited.reason.empty()) lines.back().push_back(terminal_text(audited.reason));
    }
    std::vector<std::size_t> widths(block.size() + 1, 0);
    for (const auto& line : lines)
      for (std::size_t i = 0; i < line.size() && (i == 0 || line.size() == widths.size()); ++i)
        widths[i] = std::max(widths[i], width_of(line[i]));
    for (const auto& line : lines) {
      for (std::size_t i = 0; i < line.size(); ++i) {
        text += line[i];
        const std::size_t wide = widths[i] + kGap, own = width_of(line[i]);
        if (i + 1 < line.size()) text.append(wide > own ? wide - own : kGap, ' ');
      }
      text.erase(text.find_last_not_of(' ') + 1);
      text += "\n";
    }
    text += "\n";
  }
  for (const AuditReading& reading : audit_readings(all))
    text += reading.property + ": " + terminal_text(reading.sentence) + "\n";
  return text;
}

}  // namespace isoline::reports
