// One claim whole: what is said and by whom, the verdict, what was published and measured, the
// figures that decide it, and how to get them again.
#include <fmt/format.h>

#include <cmath>

#include "reports/sections/claim_plots.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "reports/statistics/resampling.h"

namespace isoline::reports {
namespace {

std::string band_text(const Agreement& band) {
  const bool is_narrow = band.low < band.high && figure(band.low) == figure(band.high);
  const auto written = is_narrow ? exact_figure : static_cast<std::string (*)(Real)>(figure);
  const std::string low = (band.is_low_open ? "more than " : "") + written(band.low);
  const std::string high = (band.is_high_open ? "less than " : "") + written(band.high);
  if (band.low == -kNever) return band.is_high_open ? high : high + " or less";
  if (band.high == kNever) return band.is_low_open ? low : low + " or more";
  return band.low == band.high ? fmt::format("{} exactly", low)
                               : fmt::format("{} to {}", low, high);
}

std::string measured_sentence(const Judgement& judgement) {
  if (!judgement.measured) return "Nothing: there are no runs of it.";
  std::string text = measured_text(judgement);
  if (judgement.measured->n > 1)
    text += fmt::format("; in brackets the {}", interval_name(judgement.measured->n));
  return text + ".";
}

std::string cells_sentence(const CellSet& set) {
  const std::string text =
      fmt::format("{} of {} iterations", counted(set.planned, "run"), set.iterations);
  const bool is_one = set.planned == 1;
  if (set.is_deciding)
    return fmt::format("{}, which {} here and {} it.", text, is_one ? "is" : "are",
                       is_one ? "decides" : "decide");
  if (set.here == set.planned) return text + ", which are here too.";
  return fmt::format("{}, of which {} are here; {}.", text, set.here,
                     set.is_long ? "--long runs the others, which takes hours"
                                 : "without --no-run the others are run");
}

std::vector<Reading> readings_of(const Judgement& judgement) {
  std::vector<Reading> all = {{"Verdict", marked_verdict(judgement) + "."},
                              {"Source", judgement.source + "."}};
  const auto add = [&](const char* title, std::string text) {
    all.push_back({title, std::move(text)});
  };
  if (judgement.band) {
    add("What is read", judgement.quantity + ".");
    add("Published",
        fmt::format("{}. That agrees with {}.", judgement.published, band_text(*judgement.band)));
    add("Measured", measured_sentence(judgement));
  }
  for (Reading& note : claim_notes(judgement)) all.push_back(std::move(note));
  for (const CellSet& set : judgement.sets) add("Cells", cells_sentence(set));
  return all;
}

std::string read_text(const EvidenceTerm& term) {
  return term.iteration ? fmt::format("at iteration {}", *term.iteration) : "at the end";
}

Table terms_table(const Evidence& evidence, const std::string& id) {
  Table table{.id = "terms-" + id,
              .title = "Figures: " + column_words(evidence.column),
              .columns = {"of", "read", "median", "least", "greatest", "runs"},
              .align = "llrrrr"};
  const std::vector<std::string> names = term_names(evidence);
  for (std::size_t i = 0; i < evidence.terms.size(); ++i) {
    const EvidenceTerm& term = evidence.terms[i];
    const auto [low, high] = std::ranges::minmax(term.runs, {}, &EvidenceRun::figure);
    table.rows.push_back(
        {names[i], read_text(term), TableCell(figure(term.level), {{"median", term.level}}),
         figure(low.figure), figure(high.figure), std::to_string(term.runs.size())});
  }
  return table;
}

std::string point_text(const std::vector<Real>& point) {
  std::vector<std::string> parts;
  for (const Real value : point) parts.push_back(fmt::format("{:.6f}", value));
  return joined(parts);
}

Table printed_table(const Evidence& evidence, const std::string& id) {
  Table table{.id = "printed-" + id,
              .title = "Printed beside measured",
              .columns = {"iteration", "published", "measured", "largest distance"},
              .align = "rrrr"};
  for (const PrintedRow& row : evidence.printed) {
    Real largest = 0;
    for (std::size_t j = 0; j < row.printed.size(); ++j)
      largest = std::max(largest, std::abs(row.reached.at(j) - row.printed[j]));
    table.rows.push_back({std::to_string(row.iteration), point_text(row.printed),
                          point_text(row.reached), figure(largest)});
  }
  return table;
}

// Run by run.
Table runs_table(const Evidence& evidence, const std::string& id) {
  Table table{.id = "runs-" + id,
              .title = "Runs",
              .columns = {"cell", "seed", "figure", "ended", "record"},
              .align = "lrrll",
              .is_folded = true};
  for (const EvidenceTerm& term : evidence.terms)
    for (const EvidenceRun& run : term.runs)
      table.rows.push_back({shown_spec(term.problem) + " × " + shown_spec(term.optimizer),
                            std::to_string(run.seed),
                            TableCell(figure(run.figure), {{"figure", run.figure}}),
                            std::string(name_of(run.status)), run.file});
  return table;
}

void show(Section& section, const Evidence& evidence, const std::string& id) {
  if (evidence.terms.empty()) return;
  for (Plot& plot : claim_plots(evidence, id)) section.plots.push_back(std::move(plot));
  if (!evidence.printed.empty()) section.tables.push_back(printed_table(evidence, id));
  section.tables.push_back(terms_table(evidence, id));
  section.tables.push_back(runs_table(evidence, id));
}

}  // namespace

Section claim_section(const Judgement& judgement) {
  Section section{.id = "claim-" + judgement.id,
                  .title = judgement.sentence,
                  .lead = {},
                  .readings = readings_of(judgement)};
  show(section, judgement.evidence, judgement.id);
  if (judgement.contrast) {
    const std::size_t tables = section.tables.size(), plots = section.plots.size();
    show(section, judgement.contrast->evidence, judgement.id + "-contrast");
    for (std::size_t i = tables; i < section.tables.size(); ++i)
      section.tables[i].title = "Contrast. " + section.tables[i].title;
    for (std::size_t i = plots; i < section.plots.size(); ++i)
      section.plots[i].title = "Contrast: " + section.plots[i].title;
  }
  section.command = repeat_command(judgement.id, judgement.sets);
  return section;
}

}  // namespace isoline::reports
