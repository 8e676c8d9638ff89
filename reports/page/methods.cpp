// The grid of measured properties, a row a method, from which its card opens.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/records/audited.h"
#include "reports/formats/escape.h"
#include "reports/page/kinds.h"
#include "reports/page/page.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

enum class Answer { yes, no, unknown };

Answer is_kept(Real deviation) {
  if (std::isnan(deviation)) return Answer::unknown;
  return deviation <= kInvariantDeviation ? Answer::yes : Answer::no;
}

Answer has_order(const Approach& approach, Real least) {
  if (std::isnan(approach.remaining)) return Answer::unknown;
  const bool is_regular = approach.residual <= kMostOrderResidual;
  return (approach.is_exact && approach.steps == 1) || (is_regular && approach.order >= least)
             ? Answer::yes
             : Answer::no;
}

Answer is_in_one_step(const Approach& approach) {
  if (std::isnan(approach.remaining)) return Answer::unknown;
  return approach.is_exact && approach.steps == 1 ? Answer::yes : Answer::no;
}

struct Property {
  const char *name, *meaning;
  Answer (*answer)(const AuditedOptimizer& audited);
};

const Property kProperties[] = {
    {"units of x", "the path in y is the same in other units of each component of x",
     [](const AuditedOptimizer& a) { return is_kept(a.deviations[0]); }},
    {"rotation of x", "the path in y is the same in rotated coordinates of x",
     [](const AuditedOptimizer& a) { return is_kept(a.deviations[1]); }},
    {"linear map of x", "the path in y is the same under any linear map of x",
     [](const AuditedOptimizer& a) { return is_kept(a.deviations[2]); }},
    {"units of y", "the path in x is the same in other units of each component of y",
     [](const AuditedOptimizer& a) { return is_kept(a.deviations[3]); }},
    {"rotation of y", "the path in x is the same in rotated coordinates of y",
     [](const AuditedOptimizer& a) { return is_kept(a.deviations[4]); }},
    {"linear map of y", "the path in x is the same under any linear map of y",
     [](const AuditedOptimizer& a) { return is_kept(a.deviations[5]); }},
    {"one step", "reaches a regular solution in one step",
     [](const AuditedOptimizer& a) { return is_in_one_step(a.regular); }},
    {"superlinear", "order 1.5 or more near a regular solution",
     [](const AuditedOptimizer& a) { return has_order(a.regular, 1.5); }},
    {"singular too", "order 1.5 or more where J is singular at the solution",
     [](const AuditedOptimizer& a) { return has_order(a.singular, 1.5); }},
    {"as declared", "asked for no oracle that its entry does not name",
     [](const AuditedOptimizer& a) { return a.flags.empty() ? Answer::yes : Answer::no; }}};

const AuditedOptimizer* audit_of(const Comparison& c, std::size_t s) {
  const auto& all = c.study->audits;
  const auto at = std::ranges::find(all, c.optimizers[s].method, &AuditedOptimizer::name);
  return at == all.end() ? nullptr : &*at;
}

std::string answer_html(const Property& property, const AuditedOptimizer* audited) {
  const Answer answer = audited == nullptr ? Answer::unknown : property.answer(*audited);
  if (answer == Answer::yes) return "<td class=yes>✓";
  return answer == Answer::no ? "<td class=no>✗" : "<td class=none>";
}

std::string row_html(const Comparison& c, std::size_t s) {
  const OptimizerAxis& axis = c.optimizers[s];
  std::string html = fmt::format(
      "<tr data-s={0}><th scope=row><a href=\"#optimizer-{0}\">{1}{2}</a>{3}<td class=text>{4}", s,
      swatch(), html_text(optimizer_name(axis)), dagger(axis.privileges),
      kind_title(axis.mathematics()));
  for (const Property& property : kProperties) html += answer_html(property, audit_of(c, s));
  return html + fmt::format("<td class=text>{}<td class=text>{}\n",
                            axis.sheet == nullptr ? "" : html_text(joined(axis.sheet->oracles)),
                            html_text(joined(axis.privileges)));
}

}  // namespace

std::string methods_html(const Comparison& c) {
  std::string html =
      "<table class=\"grid sortable\" id=methods-table><caption>Methods by rank; press a name for "
      "its card</caption><thead><tr><th scope=col>method<th scope=col>kind";
  std::string legend;
  for (const Property& property : kProperties) {
    html += fmt::format("<th scope=col>{}", property.name);
    legend += fmt::format("{}<b>{}</b>: {}", legend.empty() ? "" : " · ", property.name,
                          property.meaning);
  }
  html += "<th scope=col>asks for<th scope=col id=privileges>† privileged information<tbody>\n";
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) html += row_html(c, s);
  return "<div class=\"scroll pane\" tabindex=0 role=region aria-label=Methods>" + html +
         "</table></div><p class=legend>Measured on small problems whose answers are known, at "
         "default options. " +
         legend + ". Empty: not measured.</p>";
}

}  // namespace isoline::reports
