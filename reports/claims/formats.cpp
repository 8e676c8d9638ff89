// The verdicts on claims as HTML, Markdown, text for a terminal, and JSON.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/claims/claims.h"
#include "reports/text.h"

namespace isoline::reports {
namespace {

// What a reader must know beside the figures: what it was held against, why not, and what differs
// from the source.
std::string remarks_of(const Judgement& judgement) {
  std::vector<std::string> parts;
  if (const auto& contrast = judgement.contrast)
    parts.push_back(fmt::format("Held against the {}: published {}, measured {}.",
                                contrast->quantity, contrast->published,
                                contrast->measured ? figure(contrast->measured->value) : "–"));
  if (!judgement.why.empty()) parts.push_back(judgement.why + ".");
  if (!judgement.caveat.empty()) parts.push_back(judgement.caveat);
  return fmt::format("{}", fmt::join(parts, " "));
}

std::string value_text(const Judgement& judgement) {
  return judgement.measured ? figure(judgement.measured->value) : "–";
}

std::string interval_text(const Judgement& judgement) {
  const auto& measured = judgement.measured;
  if (!measured || std::isnan(measured->low)) return "–";
  return fmt::format("{}–{}", figure(measured->low), figure(measured->high));
}

std::string seeds_text(const Judgement& judgement) {
  return judgement.measured ? std::to_string(judgement.measured->n) : "–";
}

std::string_view mark_of(Verdict verdict) {
  constexpr std::array<std::string_view, 4> kMarks = {"✓", "≈", "✗", "·"};
  return kMarks[static_cast<std::size_t>(verdict)];
}

Json measurement_json(const Measurement& measured) {
  return {{"value", json_number(measured.value)},
          {"low", json_number(measured.low)},
          {"high", json_number(measured.high)},
          {"n", measured.n}};
}

}  // namespace

std::string measured_text(const Judgement& judgement) {
  if (!judgement.measured) return "–";
  const std::string interval = interval_text(judgement);
  return fmt::format("{}{}, n = {}", value_text(judgement),
                     interval == "–" ? "" : fmt::format(" ({})", interval), judgement.measured->n);
}

std::string claims_reading(const std::vector<Judgement>& judgements) {
  std::array<std::size_t, kVerdictNames.size()> counts{};
  for (const Judgement& judgement : judgements)
    ++counts[static_cast<std::size_t>(judgement.verdict)];
  return fmt::format("Of {} claims {} are reproduced, {} partly, {} not; {} cannot be compared.",
                     judgements.size(), counts[0], counts[1], counts[2], counts[3]);
}

std::string claims_html(const std::vector<Judgement>& judgements) {
  if (judgements.empty())
    return "<p class=lead>No published claim is decided by the runs of this report.</p>";
  std::string html = fmt::format(
      "<p class=reading>{}</p><div class=scroll tabindex=0 role=region "
      "aria-label=Claims><table class=sortable><thead><tr><th scope=col>claim<th "
      "scope=col>verdict<th scope=col>published"
      "<th scope=col>measured<th scope=col>95 %<th scope=col>seeds<th scope=col>remarks<tbody>\n",
      html_text(claims_reading(judgements)));
  for (const Judgement& judgement : judgements)
    html += fmt::format(
        "<tr id=\"claim-{}\"><th scope=row title=\"{}\">{}<br><small>{}</small><td>{} "
        "{}<td>{}<td>{}<td>{}"
        "<td>{}<td>{}</tr>\n",
        html_text(judgement.id), html_text(judgement.quantity), html_text(judgement.sentence),
        html_text(judgement.source), mark_of(judgement.verdict), name_of(judgement.verdict),
        html_text(judgement.published), html_text(value_text(judgement)),
        html_text(interval_text(judgement)), seeds_text(judgement),
        html_text(remarks_of(judgement)));
  return html + "</table></div>\n";
}

std::string claims_markdown(const std::vector<Judgement>& judgements) {
  if (judgements.empty()) return "";
  std::string text = fmt::format(
      "\n## Claims of the papers\n\n{} Measured are medians over seeds, with 95 % of the bootstrap "
      "over seeds.\n\n| claim | verdict | published | measured | 95 % | seeds | remarks |\n"
      "|---|---|---:|---:|---:|---:|---|\n",
      claims_reading(judgements));
  for (const Judgement& judgement : judgements)
    text += fmt::format("| {} ({}) | {} | {} | {} | {} | {} | {} |\n",
                        markdown_text(judgement.sentence), markdown_text(judgement.source),
                        name_of(judgement.verdict), markdown_text(judgement.published),
                        value_text(judgement), interval_text(judgement), seeds_text(judgement),
                        markdown_text(remarks_of(judgement)));
  return text;
}

std::string claims_terminal(const std::vector<Judgement>& judgements) {
  std::string text;
  for (const Judgement& judgement : judgements) {
    text += fmt::format("{:14}  {}: {}\n", name_of(judgement.verdict), judgement.id,
                        terminal_text(judgement.sentence));
    text += fmt::format("{:14}  published {}; measured {}\n", "", judgement.published,
                        terminal_text(measured_text(judgement)));
    const std::string remarks = remarks_of(judgement);
    if (!remarks.empty()) text += fmt::format("{:14}  {}\n", "", terminal_text(remarks));
  }
  return text + claims_reading(judgements) + "\n";
}

Json claims_json(const std::vector<Judgement>& judgements) {
  Json list = Json::array();
  for (const Judgement& judgement : judgements) {
    Json json{{"id", judgement.id},
              {"sentence", judgement.sentence},
              {"source", judgement.source},
              {"quantity", judgement.quantity},
              {"published", judgement.published},
              {"verdict", std::string(name_of(judgement.verdict))},
              {"why", judgement.why},
              {"caveat", judgement.caveat},
              {"measured", nullptr}};
    if (judgement.measured) json["measured"] = measurement_json(*judgement.measured);
    if (const auto& contrast = judgement.contrast)
      json["contrast"] = {
          {"quantity", contrast->quantity},
          {"published", contrast->published},
          {"measured", contrast->measured ? measurement_json(*contrast->measured) : Json(nullptr)}};
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace isoline::reports
