// One claim whole: what is said and by whom, the verdict, what was published and measured, the
// figures that decide it, and how to get them again.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/results/statistics.h"
#include "reports/sections/figures.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

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
        {names[i], term.iteration ? fmt::format("at iteration {}", *term.iteration) : "at the end",
         TableCell(figure(term.level), {{"median", term.level}}), figure(low.figure),
         figure(high.figure), std::to_string(term.runs.size())});
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

void show(Section& section, const Evidence& evidence, const std::string& id,
          const std::string& prefix) {
  if (evidence.terms.empty()) return;
  for (Plot& plot : claim_plots(evidence, id)) {
    plot.title = (prefix.empty() ? "" : prefix + ": ") + plot.title;
    section.plots.push_back(std::move(plot));
  }
  std::vector<Table> tables;
  if (!evidence.printed.empty()) tables.push_back(printed_table(evidence, id));
  tables.push_back(terms_table(evidence, id));
  tables.push_back(runs_table(evidence, id));
  for (Table& table : tables) {
    table.title = (prefix.empty() ? "" : prefix + ". ") + table.title;
    section.tables.push_back(std::move(table));
  }
}

}  // namespace

Section claim_section(const Judgement& judgement) {
  Section section{.id = "claim-" + judgement.id,
                  .title = judgement.sentence,
                  .lead = {},
                  .readings = readings_of(judgement)};
  show(section, judgement.evidence, judgement.id, "");
  for (std::size_t i = 0; i < judgement.contrasts.size(); ++i) {
    const std::string number = i == 0 ? "" : fmt::format("-{}", i + 1);
    show(section, judgement.contrasts[i].evidence, judgement.id + "-contrast" + number, "Contrast");
  }
  section.command = repeat_command(judgement.id, judgement.sets);
  return section;
}

// The verdicts on claims of papers, and the figures they rest on.

namespace {

constexpr const char* kNothing = "–";

std::string value_text(const Judgement& judgement) {
  return judgement.measured ? figure(judgement.measured->value) : kNothing;
}

std::string interval_text(const Judgement& judgement) {
  const auto& measured = judgement.measured;
  if (!measured || std::isnan(measured->low)) return kNothing;
  return fmt::format("{}–{}", figure(measured->low), figure(measured->high));
}

// "10–30 (range of 3)": so few seeds have no interval.
std::string over_seeds(const Judgement& judgement) {
  std::string text = interval_text(judgement);
  if (text == kNothing || judgement.measured->n >= kFewestForInterval) return text;
  return fmt::format("{} ({})", text, interval_name(judgement.measured->n));
}

std::string_view mark_of(Verdict verdict) {
  constexpr std::array<std::string_view, kVerdictNames.size()> kMarks = {"✓", "✓", "∼", "≈", "≁",
                                                                         "✗", "…", "·", "·"};
  return kMarks[static_cast<std::size_t>(verdict)];
}

std::string seeds_text(const Judgement& judgement) {
  return judgement.measured ? std::to_string(judgement.measured->n) : kNothing;
}

std::vector<TableCell> claim_row(const Judgement& judgement) {
  std::vector<std::string> remarks;
  for (const Reading& note : claim_notes(judgement)) remarks.push_back(note.text);
  TableCell claim = judgement.sentence;
  claim.note = judgement.quantity;
  claim.remark = judgement.source;
  claim.link = "#claim-" + judgement.id;
  return {claim,
          marked_verdict(judgement),
          judgement.published,
          value_text(judgement),
          over_seeds(judgement),
          seeds_text(judgement),
          joined(remarks, " ")};
}

}  // namespace

std::string measured_text(const Judgement& judgement) {
  if (!judgement.measured) return kNothing;
  const std::string interval = interval_text(judgement);
  return fmt::format("{}{}, n = {}", value_text(judgement),
                     interval == kNothing ? "" : fmt::format(" ({})", interval),
                     judgement.measured->n);
}

std::string marked_verdict(const Judgement& judgement) {
  return fmt::format("{} {}", mark_of(judgement.verdict), verdict_text(judgement));
}

// Remarks besides the values: the comparison, other readings, reasons, and differences from the
// source.
std::vector<Reading> claim_notes(const Judgement& judgement) {
  std::vector<Reading> notes;
  const auto add = [&](const char* title, std::string text) {
    notes.push_back({title, std::move(text)});
  };
  for (const Contrast& contrast : judgement.contrasts)
    add("Contrast", fmt::format("Checked against the {}: published {}, measured {}.",
                                contrast.quantity, contrast.published,
                                contrast.measured ? figure(contrast.measured->value) : kNothing));
  for (const OtherReading& other : judgement.others)
    add("Read otherwise", fmt::format("Read {}: {}, {}.", other.how, figure(other.measured.value),
                                      name_of(other.verdict)));
  if (const auto& measured = judgement.measured; measured && measured->predicted)
    if (judgement.is_of_one_run)
      add("One published run",
          fmt::format("One further run of ours would lie from {} to {}.",
                      figure(measured->predicted->low), figure(measured->predicted->high)));
  if (!judgement.reading.empty()) add("Published figure", judgement.reading);
  if (!judgement.why.empty()) add("Why", judgement.why + ".");
  if (!judgement.survives.empty())
    add("Not refutable",
        fmt::format("The data could not refute it: {} would come to the same verdict.",
                    joined(judgement.survives, " and ")));
  if (judgement.fact != judgement.id) add("Fact", fmt::format("Counted with {}.", judgement.fact));
  if (!judgement.caveat.empty()) add("Caveat", judgement.caveat);
  return notes;
}

std::string verdict_text(const Judgement& judgement) {
  if (judgement.is_verification && judgement.verdict == Verdict::reproduced) return "verified";
  if (judgement.is_verification && is_decided(judgement.verdict)) return "not verified";
  std::string text(name_of(judgement.verdict));
  if (is_decided(judgement.verdict)) text += fmt::format(", n = {}", judgement.measured->n);
  return text;
}

std::string claims_reading(const std::vector<Judgement>& judgements) {
  const std::vector<Verdict> facts = verdicts_on_facts(judgements, false),
                             identities = verdicts_on_facts(judgements, true);
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < kVerdictNames.size(); ++i)
    if (const auto count = std::ranges::count(facts, static_cast<Verdict>(i)); count > 0)
      parts.push_back(fmt::format("{} {}", count, kVerdictNames[i]));
  if (const auto decided = std::ranges::count_if(identities, is_decided); decided > 0)
    parts.push_back(fmt::format("{} of {} identities and printed digits verified, counted apart",
                                std::ranges::count(identities, Verdict::reproduced), decided));
  std::string text = fmt::format("{} in {}: {}.", counted(facts.size() + identities.size(), "fact"),
                                 counted(judgements.size(), "claim"), joined(parts));
  const auto surviving = std::ranges::count_if(
      judgements, [](const Judgement& judgement) { return !judgement.survives.empty(); });
  if (surviving > 0)
    text += fmt::format(" {} of the claims could not have been refuted by these runs.", surviving);
  return text;
}

Section claims_section(const std::vector<Judgement>& judgements) {
  Section section{.id = "claims",
                  .title = "Claims of the papers",
                  .otherwise = "No published claim is decided by the runs of this report."};
  if (judgements.empty()) return section;
  section.lead =
      "Measured are medians over seeds, with 95 % of the bootstrap over seeds, or the range of "
      "fewer "
      "than six. Reproduced: all of that lies within the error of what was published, or, where "
      "that "
      "is one run, one further run of ours may be it. Consistent: some of it does. Stronger: all "
      "of "
      "it is better than published. Partly: all of it is on the published side of a tie, with a "
      "third to three times the published effect. Fewer than six seeds are consistent or at odds. "
      "Claims that restate one fact count once, by the weakest.";
  section.readings = {{"", claims_reading(judgements)}};
  Table& table = section.tables.emplace_back(Table{
      .id = "claims-table",
      .columns = {"claim", "verdict", "published", "measured", "over seeds", "seeds", "remarks"},
      .align = "plrrrrp"});
  for (const Judgement& judgement : judgements) {
    table.rows.push_back(claim_row(judgement));
    table.row_topics.push_back({.claim = judgement.id});
  }
  return section;
}

namespace {

std::string rough_time(Real seconds) {
  constexpr Real kMinute = 60;
  if (seconds < 1) return "< 1 s";
  return seconds < 2 * kMinute ? fmt::format("{:.0f} s", seconds)
                               : fmt::format("{:.0f} min", seconds / kMinute);
}

}  // namespace

Section papers_section(const std::vector<Judgement>& judgements) {
  Section section{.id = "papers",
                  .title = "The papers, sentence by sentence",
                  .readings = {{"", claims_reading(judgements)}}};
  for (const Judgement& judgement : judgements) {
    auto table = std::ranges::find(section.tables, judgement.paper, &Table::title);
    if (table == section.tables.end())
      table =
          section.tables.insert(table, Table{.title = judgement.paper,
                                             .columns = {"what it says", "where", "command", "time",
                                                         "published", "measured", "verdict"},
                                             .align = "lllrlll"});
    const bool has_runs = judgement.measured.has_value();
    const bool is_long = !judgement.sets.empty() && judgement.sets.back().is_long;
    const bool is_not_run = !has_runs && !judgement.sets.empty();
    std::string verdict = verdict_text(judgement);
    if (!is_decided(judgement.verdict) && !judgement.why.empty()) verdict += ": " + judgement.why;
    if (is_not_run && judgement.verdict != Verdict::undecidable) verdict = "not run here";
    table->rows.push_back(
        {judgement.sentence, judgement.place,
         fmt::format("isoline claims {}{}", judgement.id, is_long ? " --long" : ""),
         has_runs  ? rough_time(judgement.seconds)
         : is_long ? "hours"
                   : kNothing,
         judgement.published, measured_text(judgement), verdict});
  }
  return section;
}

Section claims_summary(const std::vector<Judgement>& judgements) {
  Section section{.id = "claims",
                  .title = "Claims of the papers",
                  .readings = {{"", claims_reading(judgements)}},
                  .otherwise = "No claim was judged."};
  Table& table = section.tables.emplace_back(
      Table{.columns = {"claim", "verdict", "published", "measured", "seeds"}, .align = "lllll"});
  for (const Verdict verdict : {Verdict::not_reproduced, Verdict::partly, Verdict::consistent,
                                Verdict::reproduced, Verdict::too_short, Verdict::not_comparable})
    for (const Judgement& judgement : judgements)
      if (judgement.verdict == verdict)
        table.rows.push_back({judgement.id, marked_verdict(judgement), judgement.published,
                              value_text(judgement), seeds_text(judgement)});
  return section;
}

// The published values, as marks in the papers' figures.

namespace {

// The lines of a method.
std::vector<std::size_t> optimizers_of(const Comparison& c, const Figure& figure,
                                       const std::string& method) {
  std::vector<std::size_t> optimizers;
  for (const FigureLine& line : figure.lines)
    if (c.optimizers[line.optimizer].method == method) optimizers.push_back(line.optimizer);
  return optimizers;
}

// Where a term of a claim stands across a figure; nothing where it is of another problem.
std::optional<Real> place_in(const Figure& figure, const EvidenceTerm& term) {
  const std::string problem = shown_spec(term.problem);
  const bool is_relative = std::abs(term.scale - 1) > 1e-9;
  if (figure.kind == "sweep" && is_relative == figure.is_relative)
    for (const auto& [name, x] : figure.places)
      if (name == problem) return x;
  if (figure.kind != "curve" || figure.problem != problem || is_relative) return std::nullopt;
  return term.read_at;
}

void add_mark(Figure& figure, const Comparison& c, const Judgement& claim) {
  const Evidence& evidence = claim.evidence;
  const bool is_level = evidence.kind == "value" && evidence.terms.size() == 1 && claim.band &&
                        evidence.column.find("x_error") != std::string::npos;
  if (!is_level) return;
  const EvidenceTerm& term = evidence.terms[0];
  const auto x = place_in(figure, term);
  const std::vector<std::size_t> optimizers = optimizers_of(c, figure, term.method);
  if (x && !optimizers.empty())
    figure.published.push_back(
        {.optimizer = optimizers[0],
         .name = fmt::format("{}, published: {}", term.method, column_words(evidence.column)),
         .x = *x,
         .y = evidence.published,
         .low = claim.band->low,
         .high = claim.band->high});
}

void add_methods(Figure& figure, const Comparison& c, const Judgement& claim) {
  for (const EvidenceTerm& term : claim.evidence.terms)
    if (place_in(figure, term) || shown_spec(term.problem) == figure.problem)
      for (const std::size_t optimizer : optimizers_of(c, figure, term.method))
        figure.of_the_paper.insert(optimizer);
}

}  // namespace

void add_published(std::vector<Figure>& all, const Comparison& c,
                   const std::vector<Judgement>& claims) {
  for (Figure& figure : all)
    for (const Judgement& claim : claims) {
      add_mark(figure, c, claim);
      add_methods(figure, c, claim);
    }
}

}  // namespace isoline::reports
