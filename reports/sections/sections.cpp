// Puts the sections of a report in order.
#include "reports/sections/sections.h"

#include <algorithm>

#include "reports/sections/words.h"

namespace isoline::reports {

const Section& Document::section(std::string_view id) const {
  return *std::ranges::find(sections, id, &Section::id);
}

Document document_of(Comparison comparison, std::vector<Judgement> claims) {
  Document document{.comparison = std::move(comparison), .claims = std::move(claims)};
  const Comparison& c = document.comparison;
  document.headline = headline(c);
  document.statuses = status_text(c.statuses);
  document.incomplete = missing_text(c);
  document.remarks = remarks(c);
  document.sections = {standings_section(c),
                       problems_section(c),
                       learned_section(c),
                       amortized_section(c),
                       sweeps_section(c),
                       spectra_section(c),
                       claims_section(document.claims),
                       properties_section(c.study->audits),
                       tuning_section(c),
                       statistics_section(c),
                       failures_section(c),
                       builds_section(c)};
  document.figures = figures(c);
  add_published(document.figures, c, document.claims);
  return document;
}

}  // namespace isoline::reports
