// The first screen: who leads, by how much, how sure that is, on what, and what stays open.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/formats/escape.h"
#include "reports/page/page.h"
#include "reports/read/leaders.h"
#include "reports/sections/evidence.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kPodium = 6;
constexpr Real kSure = 0.95;

std::string name_html(const Comparison& c, std::size_t s) {
  const OptimizerAxis& optimizer = c.optimizers[s];
  return fmt::format("<a href=\"#optimizer-{}\">{}</a>{}", s,
                     html_text(shown_spec(optimizer.label)), dagger(optimizer.privileges));
}

std::string times(Real ratio) { return ratio == kNever ? "∞" : fmt::format("{:.2g}×", ratio); }

std::string podium(const Comparison& c, const Lead& lead) {
  std::string html = "<ol class=podium>";
  for (std::size_t i = 0; i < lead.ranked.size() && i < kPodium; ++i)
    html += fmt::format("<li data-s={}><span>{}</span><i style=--w:{:.1f}></i><b>{:.3f}</b></li>",
                        lead.ranked[i].optimizer, name_html(c, lead.ranked[i].optimizer),
                        100 * lead.ranked[i].score, lead.ranked[i].score);
  return html + "</ol>";
}

std::string factor_html(const Comparison& c, const Lead& lead) {
  if (lead.ranked.size() < 2 || lead.compared == 0) return "<dd>no other solves anything</dd>";
  const bool is_open = lead.interval.low <= 1 && lead.interval.high >= 1;
  return fmt::format(
      "<dd><b>{}</b> the work for {}, the next: median over {} problems; 95 % of resamplings "
      "{} to {}{}</dd>",
      times(lead.factor), name_html(c, lead.ranked[1].optimizer), lead.compared,
      times(lead.interval.low), times(lead.interval.high), is_open ? ", which holds 1×" : "");
}

std::string card(const Comparison& c, const std::optional<Lead>& lead, const char* who,
                 const std::string& title) {
  std::string html = fmt::format("<article class=card data-who={}><h3>{}</h3>", who, title);
  if (!lead)
    return html + "<p class=winner>nobody</p><p>None solves any problem to 1e-6.</p></article>";
  const Scored& first = lead->ranked[0];
  return html +
         fmt::format(
             "<p class=winner>{}</p><p class=deeds>solves <b>{} of {}</b> problems to τ = 1e-6, "
             "<b>{}</b> of them with the least work</p><dl><dt>by how much</dt>{}<dt>how sure</dt>"
             "<dd><b>{}</b> of resamplings of the problems leave it first: {}</dd></dl>{}"
             "</article>\n",
             name_html(c, first.optimizer), first.solved, first.problems, first.wins,
             factor_html(c, *lead), percent(lead->stays_first),
             lead->stays_first >= kSure ? "settled for problems like these" : "not settled",
             podium(c, *lead));
}

std::string counts_html(const Comparison& c) {
  std::string html = fmt::format(
      "<ul class=tiles><li><b>{}</b>{}</li><li><b>{}</b>seed{}</li>"
      "<li><b>{}<small>/{}</small></b>runs</li>",
      c.problems.size(),
      c.names == c.problems.size()
          ? std::string(c.names == 1 ? "problem" : "problems")
          : fmt::format("settings of {} problem{}", c.names, c.names == 1 ? "" : "s"),
      c.seeds.size(), c.seeds.size() == 1 ? "" : "s", c.answered, c.planned);
  return html + fmt::format("<li class=\"{}\"><b>{}</b>failed</li></ul>",
                            c.failures.empty() ? "" : "bad", c.failures.size());
}

// What cannot be concluded, in a sentence, with the lists that say more.
std::string open_html(const Comparison& c, const std::optional<Lead>& lead) {
  std::string text;
  if (lead && lead->ranked.size() > 1 && lead->interval.low <= 1 && lead->interval.high >= 1)
    text = fmt::format("Whether {} needs less work than {} on problems like these. ",
                       shown_spec(c.optimizers[lead->ranked[0].optimizer].label),
                       shown_spec(c.optimizers[lead->ranked[1].optimizer].label));
  if (const auto limits = limits_of_evidence(c); !limits.empty()) text += limits[0] + " ";
  return html_text(text) + "<a href=\"#statistics\">All limits</a>.";
}

std::string verdict_html(const Comparison& c) {
  std::string html;
  for (const std::string& sentence : verdict(c))
    html += fmt::format("<p>{}</p>\n", html_text(sentence));
  return "<div class=verdict>" + html + "</div>";
}

}  // namespace

std::string dagger(const std::vector<std::string>& privileges) {
  if (privileges.empty()) return "";
  return fmt::format("<sup title=\"sees {}\">†</sup>", html_text(joined(privileges)));
}

std::string glance_html(const Comparison& c) {
  const bool is_order = c.names >= kFewProblems;  // fewer problems give no order over them
  const auto all = is_order ? lead_of(c, false) : std::nullopt;
  const auto open = is_order ? lead_of(c, true) : std::nullopt;
  const auto plain = std::ranges::count_if(
      c.optimizers, [](const OptimizerAxis& axis) { return axis.privileges.empty(); });
  std::string html = is_order ? "<div class=glance>" : verdict_html(c) + "<div class=glance>";
  if (is_order)
    html +=
        card(c, all, "all", fmt::format("Of all {} methods", c.optimizers.size())) +
        card(c, open, "open", fmt::format("Of the {} that see no more than they are given", plain));
  return html +
         fmt::format(
             "<article class=\"card ground\"><h3>On what</h3>{}<h3>What cannot be concluded</h3>"
             "<p>{}</p></article></div>\n",
             counts_html(c), open_html(c, open));
}

}  // namespace isoline::reports
