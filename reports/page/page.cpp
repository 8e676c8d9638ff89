// The page: its template with style and scripts, filled with tables, charts and data, in one file
// that does not need a network connection.
#include "reports/page/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "core/compress.h"
#include "core/results/ranking.h"
#include "reports/formats/formats.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::string_view embedded_page_html();
std::string_view embedded_page_css();
std::string_view embedded_page_js();

namespace {

using Parts = std::map<std::string, std::string, std::less<>>;

// Replaces each {{name}} once, by its part or else by the sentence of that key; what is put in is
// not searched again.
std::string filled(std::string_view page, const Parts& parts) {
  std::string out;
  while (true) {
    const std::size_t open = page.find("{{"), close = page.find("}}", open);
    if (open == std::string_view::npos || close == std::string_view::npos) break;
    out += page.substr(0, open);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    const auto part = parts.find(name);
    out += part == parts.end() ? html_text(words(name)) : part->second;
    page.remove_prefix(close + 2);
  }
  return out.append(page);
}

std::string remarks_html(const Document& document) {
  std::string html;
  for (const std::string& remark : document.remarks)
    html += fmt::format("<li>{}</li>", prose_html(remark));
  return html.empty() ? "" : "<ul class=remarks>" + html + "</ul>";
}

// The suites, and the last day a run began.
std::vector<std::string> origin_of(const Comparison& c) {
  constexpr std::size_t kDay = 10;
  std::vector<std::string> parts = c.study->plan.suites;
  std::string day;
  for (const Run& run : c.runs)
    day = std::max(day, run.record->provenance.run.started.substr(0, kDay));
  if (!day.empty()) parts.push_back(day);
  return parts;
}

// "quick · 2026-11-22 · 1a2b3c4", with the commits of the programs that ran.
std::string head_html(const Document& document) {
  const Comparison& c = document.comparison;
  constexpr std::size_t kShort = 7;
  std::vector<std::string> parts = origin_of(c);
  std::set<std::string> commits;
  for (const Run& run : c.runs)
    if (const auto& build = *run.record->provenance.build;
        !run.record->imported && !build.commit.empty())
      commits.insert(build.commit.substr(0, kShort));
  if (commits.size() == 1) parts.push_back(*commits.begin());
  if (commits.size() > 1) parts.push_back(counted(commits.size(), "commit"));
  return html_text(joined(parts, " · "));
}

// "quick, 2026-11-22": what tells two tabs of a browser apart.
std::string title_of(const Comparison& c) {
  const std::vector<std::string> parts = origin_of(c);
  return (parts.empty() ? "" : joined(parts) + " · ") + "Isoline";
}

// The meaning of marks except extra information, if any method or problem has them.
std::string legend_html(const Comparison& c) {
  const Marks shown = marks_shown(c);
  std::string legend;
  const auto add = [&](const char* key) {
    std::string text = words(key);
    if (text.ends_with('.')) text.pop_back();  // entries of a list
    legend += "; " + html_text(text);
  };
  if (shown.is_foreign) add("marks.foreign");
  if (shown.is_imported) add("marks.imported");
  return legend;
}

// How many of the published results agree.
std::string checked_html(const Document& document) {
  if (document.claims.empty()) return "";
  const std::vector<Verdict> facts = verdicts_on_facts(document.claims, false);
  const auto count = [&](Verdict from, Verdict to) {
    return std::ranges::count_if(facts,
                                 [&](Verdict verdict) { return verdict >= from && verdict <= to; });
  };
  return fmt::format(
      "<p class=checked>{} <a href=\"#claims\">{}</a>; <a href=\"#figures\">{}</a></p>",
      html_text(words("page.published", count(Verdict::reproduced, Verdict::reproduced),
                      count(Verdict::agrees, Verdict::agrees),
                      count(Verdict::differs, Verdict::differs),
                      count(Verdict::partly, Verdict::one_run),
                      count(Verdict::too_short, Verdict::not_comparable))),
      html_text(words("page.each-claim")), html_text(words("page.all-figures")));
}

// The share of settings solved against work, where no published result is shown.
std::string first_profile_html(const Document& document) {
  for (Plot plot : document.section("statistics").plots)
    if (plot.id == "plot-data-profile") {
      plot.id = "plot-first";
      return plot_html(plot);
    }
  return "";
}

// A published result that agrees, with the interval that decides its verdict: of the ratios with a
// stated error that with the most seeds.
std::string hero_html(const Document& document) {
  const Judgement* best = nullptr;
  for (const Judgement& one : document.claims)
    if (is_decided(one.verdict) && is_supported(one.verdict) && one.evidence.kind == "ratio" &&
        one.band && one.band->high < kNever && one.band->low < one.band->high &&
        (best == nullptr || one.measured->n > best->measured->n))
      best = &one;
  const Plots plots = best ? claim_plots(best->evidence, best->id + "-first") : Plots{};
  if (plots.empty()) return first_profile_html(document);
  const Measurement& measured = *best->measured;
  const Interval band = measured.predicted.value_or(Interval{measured.low, measured.high});
  Drawing drawing = drawing_of(plots[0]);
  if (const auto& published = plots[0].published; !published.empty()) {
    constexpr Real kBeside = .8;  // of the place of the published value, on a logarithmic axis
    const Real unit = published[0].y[0] / best->evidence.published, x = published[0].x[0] * kBeside;
    drawing.ground.push_back({{}, "", {x, x}, {unit * band.low, unit * band.high}, {}, {}});
  }
  const bool is_listed = std::ranges::any_of(
      ratio_claims(document.comparison, document.claims),
      [&](const auto& ratio) { return std::ranges::count(ratio.second, best) > 0; });
  return fmt::format(
      "<figure class=plot data-claim=\"{0}\"><figcaption><a href=\"#claim-{0}\">{1}</a> {2} {3}"
      "</figcaption>{4}{5}</figure>",
      best->id, html_text(best->sentence),
      html_text(words(measured.predicted ? "page.hero" : "page.hero-seeds", figure(measured.value),
                      figure(band.low), figure(band.high), verdict_text(*best))),
      html_text(joined(best->caveats, " ")) +
          (is_listed ? " <a href=\"#ratio-readings\">" + words("script.other-readings") + "</a>"
                     : ""),
      drawing_svg(drawing), names_html(drawing));
}

// The head of the first tab: alerts, and at most three sentences.
std::string overview_html(const Document& document) {
  const Comparison& c = document.comparison;
  std::string html;
  if (!document.incomplete.empty())
    html += fmt::format("<p class=alert role=alert><b>{}</b> {}</p>\n",
                        html_text(words("page.incomplete")), html_text(document.incomplete));
  const std::size_t unread = c.study->unreadable.size();
  if (!c.failures.empty() || unread > 0)
    html += fmt::format("<p class=alert><b>{}</b>{} — <a href=\"#failures\">{}</a></p>\n",
                        html_text(words("page.failed", c.failures.size())),
                        unread > 0 ? html_text(words("page.unreadable", unread)) : "",
                        html_text(words("page.why")));
  const char* kind = "verdict";
  for (const std::string& sentence : first_sentences(c)) {
    html += fmt::format("<p class={}>{}</p>\n", kind, html_text(sentence));
    kind = "lead";
  }
  return html;
}

// All that these runs say, folded: sentences, facts, published results.
std::string findings_html(const Document& document) {
  std::string html = "<details><summary>" + html_text(words("page.all-sentences")) +
                     "</summary><p class=lead>" + html_text(document.headline) + "</p>";
  for (const Reading& sentence : document.section("standings").readings)
    html += fmt::format("<p class=lead>{}</p>\n", html_text(sentence.text));
  html += "<dl class=settled>";
  for (const Reading& reading : ranking_facts(document.comparison))
    html += fmt::format("<dt>{}<dd>{}", html_text(reading.title), html_text(reading.text));
  return html + "</dl>" + checked_html(document) + "</details>\n";
}

// Links to parts of the page that have something to show: a method alone is not compared.
std::string links_html(const Document& document,
                       const std::vector<std::pair<std::string_view, std::string>>& links) {
  const auto is_empty = [&](std::string_view part) {
    if (part == "fit") return std::ranges::count(document.sections, "fit", &Section::id) == 0;
    if (part == "claims") return document.claims.empty() && document.figures.empty();
    return document.comparison.optimizers.size() < 2 &&
           (part == "choose" || part == "compare" || part == "statistics");
  };
  std::string html;
  for (const auto& [part, text] : links)
    if (!is_empty(part)) html += fmt::format("<a href=\"#{}\">{}</a>\n  ", part, html_text(text));
  return html;
}

// The first tab of a report on a user's own problem. The parameters stand above the plots.
std::string fit_tab(const Section& fit) {
  Section values = fit, rest{.id = fit.id, .title = fit.title};
  const auto is_of_values = [](const Table& table) {
    return table.id.starts_with("fit-parameters") || table.id.starts_with("fit-values");
  };
  rest.plots = std::exchange(values.plots, {});
  std::ranges::remove_copy_if(fit.tables, std::back_inserter(rest.tables), is_of_values);
  std::erase_if(values.tables, std::not_fn(is_of_values));
  return fmt::format(
      "<section id=\"fit\" class=\"tab\" aria-label=\"{0}\">\n<h2>{0}</h2>\n{1}{2}</section>\n",
      html_text(fit.title), section_html(values), rest.is_empty() ? "" : section_html(rest));
}

std::string endings_html(const Comparison& c) {
  std::string html = fmt::format("<li><b>{}<small>/{}</small></b>{}</li>", c.answered, c.planned,
                                 html_text(words("page.complete")));
  for (const auto& [status, count] : c.statuses)
    html += fmt::format("<li class=\"{}\"><b>{}</b>{}<small>{}</small></li>",
                        is_failure(status) ? "bad" : "", count, status_meaning(status),
                        name_of(status));
  return "<ul class=tiles>" + html + "</ul>";
}

// --- what a browser reads

constexpr std::string_view kPacks = "{{packs}}";

// Compressed, in pieces between which the parser of a browser can pause for the first painting.
std::string packed_text(std::string_view name, std::string_view text) {
  constexpr std::size_t kPiece = 1 << 15;
  const std::string all = radix64(compressed(text));
  std::string html;
  for (std::size_t at = 0; at < all.size(); at += kPiece)
    html += fmt::format("<script type=\"application/zlib\"{} class={}>{}</script>\n",
                        at == 0 ? fmt::format(" id={}", name) : "", name,
                        std::string_view(all).substr(at, kPiece));
  return html;
}

// With numbers for all letters but those of ASCII, of which a browser needs half the memory and
// half the time.
std::string ascii_html(std::string_view utf8) {
  std::string out;
  std::uint32_t letter = 0;
  for (std::size_t i = 0; i < utf8.size(); ++i) {
    const auto byte = static_cast<unsigned char>(utf8[i]);
    if (byte < 0x80) {
      out += utf8[i];
      continue;
    }
    const bool continues = byte < 0xC0;
    letter = continues ? letter << 6 | (byte & 0x3F)
                       : byte & (byte < 0xE0   ? 0x1F
                                 : byte < 0xF0 ? 0x0F
                                               : 7);
    if (i + 1 == utf8.size() || (static_cast<unsigned char>(utf8[i + 1]) & 0xC0) != 0x80)
      out += fmt::format("&#{};", letter);
  }
  return out;
}

// The largest tables go compressed, in the order of their empty places. What else a tab shows later
// is a part of its own beside the rest of the page, since elements that wait hold no others.
std::string sent(std::string_view page) {
  constexpr std::string_view kOpen = "<noscript", kClose = "</noscript>";
  std::size_t at = page.find("<noscript class=\"rest\""), open = 0;
  at = page.find('>', at);
  std::string out(page.substr(0, at)), packs;
  while ((open = page.find(kOpen, at)) != std::string_view::npos) {
    const std::size_t begin = page.find('>', open) + 1, close = page.find(kClose, begin);
    const std::string_view tag = page.substr(open, begin - open),
                           text = page.substr(begin, close - begin);
    out += page.substr(at, open - at);
    at = close + kClose.size();
    if (tag.find("rest") != std::string_view::npos) {
      out += tag;
      at = begin;
    } else if (tag.find("sent") != std::string_view::npos) {
      out += "<template class=sent></template>";
      packs.append(text) += '\0';
    } else {
      out += fmt::format(
          "</noscript><noscript class=\"rest tab-text\">{}</noscript><noscript class=rest>", text);
    }
  }
  out += page.substr(at);
  return ascii_html(out.replace(out.find(kPacks), kPacks.size(), packed_text("packs", packs)));
}

// --- kinds of methods as colours and words

bool is_kind(std::string_view kind) {
  return all_sentences().contains(fmt::format("kind.{}", kind));
}

// A share of the kind's own colour, in percent, and the colour that it is mixed with: all that come
// of it are 7 and more apart in Lab, in both themes, within a kind and between kinds.
struct Shade {
  int share;
  std::string_view mixed;
};
constexpr std::array<Shade, 5> kShadesOfKind = {
    {{100, "ink"}, {60, "ink"}, {60, "s6"}, {60, "s0"}, {70, "paper"}}};

}  // namespace

std::string kind_title(std::string_view kind) {
  return words(fmt::format("kind.{}", is_kind(kind) ? kind : "other"));
}

std::string kind_rules(const Comparison& c) {
  std::string rules;
  std::map<std::string, std::size_t> counts;
  std::set<std::string> looks;
  std::map<std::string_view, std::string> of_shape;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    std::string kind = c.optimizers[s].mathematics();
    if (!is_kind(kind)) kind = "other";
    const std::size_t place = counts[kind]++;
    const auto& [share, mixed] = kShadesOfKind[place % kShadesOfKind.size()];
    const Look look = look_of(c.optimizers[s].method);
    const std::string rule =
        fmt::format("{{--series:color-mix(in oklab,var(--{}) {}%,var(--{}));--dash:{}}}\n", kind,
                    share, mixed, look.dash);
    rules += fmt::format("[data-s=\"{}\"]", s) + rule;
    if (looks.insert(c.optimizers[s].method).second)  // of its best row
      rules += fmt::format("[data-look=\"{}\"]", html_text(c.optimizers[s].method)) + rule;
    of_shape[look.shape] +=
        fmt::format("{}[data-s=\"{}\"]", of_shape[look.shape].empty() ? "" : ",", s);
  }
  for (const auto& [shape, selectors] : of_shape)  // around (5, 5), for marks that are no drawings
    rules += fmt::format("{}{{--shape:path(\"M5 5{}\")}}\n", selectors, shape);
  return rules;
}

std::string marks_html(const OptimizerAxis& axis) {
  std::string marks;
  if (!axis.privileges.empty())
    marks = fmt::format("<sup title=\"{}\">†</sup>",
                        html_text(words("page.given", joined(axis.privileges))));
  if (axis.is_imported)
    marks += fmt::format("<sup title=\"{}\">§</sup>", html_text(words("page.imported")));
  return marks;
}

std::string readable_html(const Document& document) {
  const Comparison& c = document.comparison;
  const AllFields fields = all_found_fields(c);
  Section order = document.section("standings"), apart{.id = "apart", .title = order.title};
  const auto is_apart = [](const Table& table) { return table.id != "standings-table"; };
  std::ranges::copy_if(order.tables, std::back_inserter(apart.tables), is_apart);
  std::erase_if(order.tables, is_apart);
  const auto own = std::ranges::find(document.sections, "fit", &Section::id);
  const std::string_view style = embedded_page_css();
  const std::size_t first = style.find("/* Up to here");
  Parts parts{{"title", html_text(title_of(c))},
              {"style-first", std::string(style.substr(0, first))},
              {"style", std::string(style.substr(first)) + kind_rules(c)},
              {"program", packed_text("program", embedded_page_js())},
              {"packs", std::string(kPacks)},
              {"tau", tau_name(c)},
              {"headline", head_html(document)},
              {"page.ranking",
               html_text(words("page.ranking", counted_name(c), setting_noun(c), tau_name(c)))},
              {"page.heat", html_text(words("page.heat", unit_name(c), success_text(c)))},
              {"tabs", links_html(document, {{"fit", "Fit"},
                                             {"overview", "Overview"},
                                             {"choose", "Choose a method"},
                                             {"compare", "Compare"},
                                             {"problems", "Problems"},
                                             {"claims", "Claims"},
                                             {"methods", "Methods"},
                                             {"statistics", "Statistics"},
                                             {"runs", "All runs"}})},
              {"ways", links_html(document, {{"choose", words("page.simulator")},
                                             {"claims", words("page.paper")},
                                             {"details", words("page.doubt")}})},
              {"fit-tab", own == document.sections.end() ? "" : fit_tab(*own)},
              {"overview", overview_html(document)},
              {"hero", hero_html(document)},
              {"findings", findings_html(document)},
              {"endings", endings_html(c)},
              {"remarks", remarks_html(document)},
              {"order", section_html(order)},
              {"apart", apart.is_empty() ? "" : section_html(apart)},
              {"matrix", section_html(document.section("problems"))},
              {"problems", problems_html(c, fields)},
              {"details", details_html(c)},
              {"figures", figures_html(document)},
              {"claims", claims_html(document)},
              {"methods", methods_html(c)},
              {"optimizers", optimizers_html(c)},
              {"legend", legend_html(c)},
              {"data", packed_text("data", page_data(document, fields))}};
  for (const Section& section : document.sections)  // but those that the scripts redraw
    if (!parts.contains(section.id)) parts.emplace(section.id, section_html(section));
  return filled(embedded_page_html(), parts);
}

std::string html_report(const Document& document) { return sent(readable_html(document)); }

}  // namespace isoline::reports
