// The claims of the page: the verdicts, and for each claim a part of its own that opens when its
// row leads there.
#include <fmt/format.h>

#include <filesystem>

#include "core/files.h"
#include "reports/formats/escape.h"
#include "reports/page/page.h"
#include "reports/sections/sections.h"

namespace isoline::reports {
namespace {

namespace fs = std::filesystem;

// A path as a relative address.
std::string address(const std::string& path) {
  std::string out;
  for (const char letter : path) {
    const auto byte = static_cast<unsigned char>(letter);
    const bool is_plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                          (letter >= '0' && letter <= '9') ||
                          std::string_view("-._~/").find(letter) != std::string_view::npos;
    out += is_plain ? std::string(1, letter) : fmt::format("%{:02X}", byte);
  }
  return out;
}

// From the page to a record; empty where it is not known where either lies.
std::string record_link(const Document& document, const std::string& name) {
  if (document.out.empty()) return "";
  for (const fs::path folder : document.comparison.study->folders) {
    std::error_code unknown;
    const fs::path file = folder / "runs" / name;
    if (!is_there(file)) continue;
    const fs::path way = fs::proximate(file, document.out, unknown);
    return unknown ? "" : address(way.generic_string());
  }
  return "";
}

void link_records(const Document& document, Section& claim) {
  for (Table& table : claim.tables)
    if (!table.columns.empty() && table.columns.back() == "record")
      for (auto& row : table.rows) row.back().link = record_link(document, row.back().text);
}

std::string readings_html(const Section& claim) {
  std::string html = "<dl>";
  for (const Reading& reading : claim.readings)
    html += fmt::format("<dt>{}<dd>{}", html_text(reading.title), html_text(reading.text));
  if (!claim.command.empty())
    html += fmt::format(
        "<dt>To repeat it<dd><code>{0}</code> <button class=copy type=button "
        "data-command=\"{0}\" hidden>copy</button>",
        html_text(claim.command));
  return html + "</dl>\n";
}

std::string claim_html(const Document& document, const Judgement& judgement) {
  Section claim = claim_section(judgement);
  link_records(document, claim);
  std::string html = fmt::format(
      "<details class=claim id=\"{0}\" data-claim=\"{1}\"><summary><b>{2}</b> {3} "
      "<code>{1}</code></summary><noscript>\n",
      html_text(claim.id), html_text(judgement.id), html_text(marked_verdict(judgement)),
      html_text(claim.title));
  html += "<div class=decided>" + readings_html(claim) + "<div>";
  for (const Plot& plot : claim.plots) html += plot_html(plot);
  html += "</div></div>\n";
  claim.readings.clear();
  claim.plots.clear();
  if (!claim.tables.empty()) html += section_html(claim);
  return html + "<p><a href=\"#claims\">All verdicts</a></p></noscript></details>\n";
}

}  // namespace

std::string claims_html(const Document& document) {
  std::string html = section_html(document.section("claims"));
  if (document.claims.empty()) return html;
  html += "<h3>Each claim, and what decides it</h3>\n<div class=each-claim>";
  for (const Judgement& judgement : document.claims) html += claim_html(document, judgement);
  return html + "</div>";
}

}  // namespace isoline::reports
