// The first screen: who leads, by how much, how sure that is, on what, and what stays open.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/formats/escape.h"
#include "reports/page/page.h"
#include "reports/read/grounds.h"
#include "reports/sections/evidence.h"
#include "reports/sections/leading.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/origins.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kPodium = 5;

std::string name_html(const Comparison& c, std::size_t s) {
  const OptimizerAxis& optimizer = c.optimizers[s];
  return fmt::format("<a href=\"#optimizer-{}\">{}</a>{}", s,
                     html_text(shown_spec(optimizer.label)), dagger(optimizer.privileges));
}

std::string podium(const Comparison& c, const Lead& lead) {
  std::string html = "<ol class=podium>";
  for (std::size_t i = 0; i < lead.ranked.size() && i < kPodium; ++i)
    html += fmt::format("<li data-s={}><span>{}</span><i style=--w:{:.1f}></i><b>{:.3f}</b></li>",
                        lead.ranked[i].optimizer, name_html(c, lead.ranked[i].optimizer),
                        100 * lead.ranked[i].score, lead.ranked[i].score);
  return html + "</ol>";
}

std::string winner_html(const Comparison& c, const Lead& lead) {
  if (lead.tied == 1) return name_html(c, lead.ranked[0].optimizer);
  return "tied: " + html_text(first_text(c, lead));
}

std::string card(const Comparison& c, const std::optional<Lead>& lead, const char* who,
                 const std::string& title) {
  std::string html = fmt::format("<article class=card data-who={}><h3>{}</h3>", who, title);
  if (!lead)
    return html +
           fmt::format("<p class=winner>nobody</p><p>None solves any {} to {}.</p></article>",
                       setting_noun(c), tau_name(c));
  return html + fmt::format(
                    "<p class=winner>{}</p><p class=deeds>{}</p><dl><dt>how sure</dt><dd>{}</dd>"
                    "<dt>what these data tell</dt><dd>{}</dd></dl>{}</article>\n",
                    winner_html(c, *lead), html_text(deeds_text(c, lead->ranked[0])),
                    html_text(settled_text(c, *lead)), html_text(power_text(c, *lead)),
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
std::string open_html(const Comparison& c) {
  std::string text;
  if (const auto limits = limits_of_evidence(c); !limits.empty())
    text = limits.front() + " " + limits.back() + " ";
  return html_text(text) + "<a href=\"#statistics\">All limits</a>.";
}

// What is told of the whole report alone: of prices, rates, and who is not in the order of the
// cards.
std::string told_html(const std::string& text) {
  return text.empty() ? "" : fmt::format("<p class=whole>{}</p>", html_text(text));
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
  const bool is_order = has_order(c);  // fewer problems give no order over them
  const auto plain = std::ranges::count_if(
      c.order.methods, [&](std::size_t s) { return c.optimizers[s].privileges.empty(); });
  std::string html = is_order ? "<div class=glance>" : verdict_html(c) + "<div class=glance>";
  if (is_order)
    html += card(c, c.lead, "all",
                 fmt::format("Of the {} methods that are ranked", c.order.methods.size())) +
            card(c, c.open_lead, "open",
                 fmt::format("Of the {} that see no more than they are given", plain));
  return html +
         fmt::format(
             "<article class=\"card ground\"><h3>On what</h3>{}{}{}{}<h3>What cannot be concluded</h3>"
             "<p class=limits>{}</p></article></div>\n",
             counts_html(c), is_order ? told_html(prices_text(c)) : "", told_html(rates_text(c)),
             is_order ? told_html(apart_sentence(c)) : "", open_html(c));
}

}  // namespace isoline::reports
