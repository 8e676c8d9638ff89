// One claim with its source, its verdict, the published and the measured value, the values that
// decide it, and the command that repeats it.
#include "reports/sections/claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/seeds.h"
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

std::string cells_sentence(const CellSet& set) {
  const std::string text = words("claim.cells", set.planned, set.iterations);
  if (set.is_deciding) return text + words("claim.cells.deciding", set.planned);
  if (set.here == set.planned) return text + words("claim.cells.here");
  return text + words(set.is_long ? "claim.cells.long" : "claim.cells.others", set.here);
}

std::vector<Reading> readings_of(const Judgement& judgement) {
  std::vector<Reading> all = {{"Verdict", marked_verdict(judgement) + "."},
                              {"Source", judgement.source + "."}};
  if (judgement.band) {
    const auto& measured = judgement.measured;
    const std::string interval =
        measured && measured->n > 1 ? words("claim.interval", interval_name(measured->n)) : "";
    const bool is_here =
        std::ranges::any_of(judgement.sets, [](const CellSet& set) { return set.here > 0; });
    all.push_back({"Quantity", judgement.quantity + "."});
    all.push_back(
        {"Published", words("claim.published", judgement.published, band_text(*judgement.band))});
    all.push_back({"Measured", measured
                                   ? measured_text(judgement) + interval + "."
                                   : words(is_here ? "claim.partly-here" : "claim.unmeasured")});
  }
  for (Reading& note : claim_notes(judgement)) all.push_back(std::move(note));
  for (const CellSet& set : judgement.sets) all.push_back({"Cells", cells_sentence(set)});
  return all;
}

// A table of the evidence of a claim, which IDs and titles name.
Table evidence_table(const char* key, const Evidence& evidence, const std::string& id) {
  Table table = worded_table(key, column_words(evidence.column));
  table.id += "-" + id;
  return table;
}

Table terms_table(const Evidence& evidence, const std::string& id) {
  Table table = evidence_table("terms", evidence, id);
  const std::vector<std::string> names = term_names(evidence);
  for (std::size_t i = 0; i < evidence.terms.size(); ++i) {
    const EvidenceTerm& term = evidence.terms[i];
    const auto [low, high] = std::ranges::minmax(term.runs, {}, &EvidenceRun::figure);
    const char* otherwise = evidence.is_over_time ? "at equal processor time" : "at the end";
    table.rows.push_back(
        {names[i], term.iteration ? fmt::format("at iteration {}", *term.iteration) : otherwise,
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
  Table table = evidence_table("printed", evidence, id);
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
  Table table = evidence_table("runs", evidence, id);
  table.is_folded = true;
  for (const EvidenceTerm& term : evidence.terms)
    for (const EvidenceRun& run : term.runs)
      table.rows.push_back({shown_spec(term.problem) + " × " + shown_spec(term.optimizer),
                            seed_text(run.seed),
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
  for (const auto table_of : {printed_table, terms_table, runs_table}) {
    Table table = table_of(evidence, id);
    table.title = (prefix.empty() ? "" : prefix + ". ") + table.title;
    if (!table.rows.empty()) section.tables.push_back(std::move(table));
  }
}

}  // namespace

Section claim_section(const Judgement& judgement) {
  Section section{.id = "claim-" + judgement.id, .title = judgement.sentence};
  section.readings = readings_of(judgement);
  show(section, judgement.evidence, judgement.id, "");
  for (std::size_t i = 0; i < judgement.contrasts.size(); ++i) {
    const std::string number = i == 0 ? "" : fmt::format("-{}", i + 1);
    show(section, judgement.contrasts[i].evidence, judgement.id + "-contrast" + number, "Contrast");
  }
  section.command = repeat_command(judgement.id, judgement.sets);
  return section;
}

namespace {

constexpr const char* kNothing = "–";

// The quantity of the medians over seeds, and beside it the geometric mean of the seeds, which the
// verdict compares, where that is another number.
std::string value_text(const Judgement& judgement) {
  if (!judgement.measured) return kNothing;
  const std::string value = figure(judgement.measured->value);
  const std::string& kind = judgement.evidence.kind;
  Real sum = 0;
  for (const Real each : judgement.measured->each) sum += std::log(each);
  const auto n = static_cast<Real>(judgement.measured->each.size());
  const bool has_mean = n > 1 && std::isfinite(sum) && (kind == "ratio" || kind == "value");
  const std::string mean = has_mean ? figure(std::exp(sum / n)) : value;
  return mean == value ? value : fmt::format("{}, mean {}", value, mean);
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
  constexpr std::array<std::string_view, kVerdictNames.size()> kMarks = {"✓", "∼", "≈", "≁", "·",
                                                                         "✗", "…", "·", "·"};
  return kMarks[static_cast<std::size_t>(verdict)];
}

std::string seeds_text(const Judgement& judgement) {
  return judgement.measured ? std::to_string(judgement.measured->n) : kNothing;
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
  for (const Contrast& contrast : judgement.contrasts) {
    const bool has_article = contrast.quantity.starts_with("the ");
    notes.push_back(
        {"Contrast", words("claim.contrast", (has_article ? "" : "the ") + contrast.quantity,
                           contrast.published,
                           contrast.measured ? figure(contrast.measured->value) : kNothing)});
  }
  if (judgement.alone)
    notes.push_back({"This reading", words("claim.alone", name_of(*judgement.alone))});
  for (const OtherReading& other : judgement.others)
    notes.push_back(
        {"Other reading",
         is_error_ratio(judgement)  // one table has all values
             ? words("claim.listed", other.how, name_of(other.verdict))
             : words("claim.otherwise", other.how, other.measured.value, name_of(other.verdict))});
  if (const auto& measured = judgement.measured;
      measured && measured->predicted && judgement.is_of_one_run)
    notes.push_back({"One published run",
                     words("claim.one-run", measured->predicted->low, measured->predicted->high)});
  if (const auto& direction = judgement.direction)
    notes.push_back(
        {"Direction", words("claim.direction", direction->with, direction->seeds, direction->p)});
  if (!judgement.break_even.empty()) notes.push_back({"Cost of a step", judgement.break_even});
  if (!judgement.reading.empty()) notes.push_back({"Published figure", judgement.reading});
  if (!judgement.why.empty()) notes.push_back({"Reason", judgement.why + "."});
  if (!judgement.survives.empty())
    notes.push_back(
        {"Not refutable", words("claim.survives", joined(judgement.survives, " and "))});
  if (!judgement.reached.empty()) notes.push_back({"Published records", judgement.reached + "."});
  if (judgement.fact != judgement.id)
    notes.push_back({"Fact", fmt::format("Counts as one fact with {}.", judgement.fact)});
  for (const std::string& caveat : judgement.caveats) notes.push_back({"Caveat", caveat});
  return notes;
}

std::string verdict_text(const Judgement& judgement) {
  if (judgement.is_verification && judgement.verdict == Verdict::reproduced) return "verified";
  if (judgement.is_verification && is_decided(judgement.verdict)) return "not verified";
  if (judgement.verdict == Verdict::one_run) return words("claim.no-spread");
  std::string text(name_of(judgement.verdict));
  if (is_decided(judgement.verdict)) text += fmt::format(", n = {}", judgement.measured->n);
  return text;
}

namespace {

// The kind of its number, to stand before it, where that is not the value in the sentence: "ratio
// ".
std::string kind_of_measure(const Judgement& judgement) {
  const std::string& kind = judgement.evidence.kind;
  if (!judgement.measured || kind == "value" || kind == "equality") return "";
  return (kind == "position"          ? "place"
          : kind == "greatest"        ? "largest"
          : kind == "ratio_slope"     ? "slope"
          : kind == "mean_difference" ? "difference"
          : kind == "crossing"        ? "crossing at"
                                      : kind) +
         " ";
}

bool is_not_run(const Judgement& judgement) {
  return !judgement.measured && !judgement.sets.empty();
}

}  // namespace

std::string claims_reading(const std::vector<Judgement>& judgements) {
  const std::vector<Verdict> facts = verdicts_on_facts(judgements, false),
                             identities = verdicts_on_facts(judgements, true);
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < kVerdictNames.size(); ++i)
    if (const auto count = std::ranges::count(facts, static_cast<Verdict>(i)); count > 0)
      parts.push_back(fmt::format("{} {}", count, kVerdictNames[i]));
  if (const auto decided = std::ranges::count_if(identities, is_decided); decided > 0)
    parts.push_back(
        words("claims.identities", std::ranges::count(identities, Verdict::reproduced), decided));
  std::string text =
      words("claims.reading", facts.size() + identities.size(), judgements.size(), joined(parts));
  if (const auto count = std::ranges::count_if(judgements, is_not_run); count > 0)
    text += " " + words("claims.not-run", count);
  std::vector<std::string> surviving;
  for (const Judgement& judgement : judgements)
    if (!judgement.survives.empty()) surviving.push_back(judgement.id);
  if (!surviving.empty())
    text += " " + words("claims.surviving", surviving.size(), first_of(surviving, 5));
  return text;
}

Section claims_section(const std::vector<Judgement>& judgements) {
  Section section = worded_section("claims");
  if (judgements.empty()) return section;
  section.readings = {{"", claims_reading(judgements)}};
  Table& table = section.tables.emplace_back(worded_table("claims-table"));
  constexpr std::size_t kRepeated = 3;  // a remark of so many claims stands below the table, once
  std::map<std::string, std::size_t> counts;
  std::vector<std::string> below;
  for (const Judgement& judgement : judgements)
    for (const Reading& note : claim_notes(judgement)) ++counts[note.text];
  for (const Judgement& judgement : judgements) {
    std::vector<std::string> remarks;
    for (const Reading& note : claim_notes(judgement)) {
      if (counts[note.text] < kRepeated) {
        remarks.push_back(note.text);
        continue;
      }
      const auto at = std::ranges::find(below, note.text);
      remarks.push_back(fmt::format("[{}]", at - below.begin() + 1));
      if (at == below.end()) below.push_back(note.text);
    }
    TableCell claim = judgement.sentence;
    claim.note = judgement.quantity;
    claim.remark = judgement.source;
    claim.link = "#claim-" + judgement.id;
    table.rows.push_back({claim, marked_verdict(judgement), judgement.published,
                          value_text(judgement), over_seeds(judgement), seeds_text(judgement),
                          joined(remarks, " ")});
    table.row_topics.push_back({.claim = judgement.id});
  }
  for (std::size_t i = 0; i < below.size(); ++i)
    table.caption += fmt::format("{}[{}] {}", table.caption.empty() ? "" : " ", i + 1, below[i]);
  return section;
}

Section papers_section(const std::vector<Judgement>& judgements) {
  Section section = worded_section("papers");
  section.readings = {{"", claims_reading(judgements)},
                      {"", words("papers.thresholds")},
                      {"", words("papers.kinds")}};
  for (const Judgement& judgement : judgements) {
    auto table = std::ranges::find(section.tables, judgement.paper, &Table::title);
    if (table == section.tables.end()) {
      table = section.tables.insert(table, worded_table("papers-table"));
      table->title = judgement.paper;
    }
    constexpr Real kMinute = 60;
    const auto rough_time = [](Real seconds) {
      return seconds < 1             ? "< 1 s"
             : seconds < 2 * kMinute ? fmt::format("{:.0f} s", seconds)
                                     : fmt::format("{:.0f} min", seconds / kMinute);
    };
    const bool has_runs = judgement.measured.has_value();
    const auto is_short_enough = [&](const CellSet& set) {
      return !set.is_long && set.iterations >= judgement.needs;
    };
    const bool is_long =
        takes_hours(judgement.sets) || (std::ranges::any_of(judgement.sets, &CellSet::is_long) &&
                                        std::ranges::none_of(judgement.sets, is_short_enough));
    std::string verdict = verdict_text(judgement);
    if (!is_decided(judgement.verdict) && !judgement.why.empty()) verdict += ": " + judgement.why;
    if (is_not_run(judgement) && judgement.verdict != Verdict::undecidable) verdict = "not run";
    if (is_decided(judgement.verdict) && !is_supported(judgement.verdict))
      for (const Contrast& contrast : judgement.contrasts)
        if (contrast.measured)
          verdict += "; " + words("claim.paper-contrast", contrast.published,
                                  figure(contrast.measured->value));
    if (judgement.alone) {  // the value of the row does not explain the verdict
      verdict += "; " + words("claim.paper-alone", name_of(*judgement.alone));
      for (const OtherReading& other : judgement.others)
        verdict += "; " + words("claim.paper-other", other.how, figure(other.measured.value),
                                name_of(other.verdict));
    }
    if (const auto& measured = judgement.measured;
        measured && measured->predicted && judgement.is_of_one_run)
      verdict +=
          "; " + words("claim.paper-one-run", measured->predicted->low, measured->predicted->high);
    if (!judgement.reached.empty() && judgement.verdict != Verdict::too_short)
      verdict += "; " + judgement.reached;
    if (!judgement.deviation.empty()) verdict += ". " + judgement.deviation;
    if (!judgement.break_even.empty()) {
      if (!verdict.ends_with('.')) verdict += '.';
      verdict += " " + judgement.break_even;
    }
    table->row_topics.push_back({.claim = judgement.id});
    table->rows.push_back(
        {judgement.sentence, judgement.place,
         fmt::format("isoline claims {}{}", judgement.id, is_long ? " --long" : ""),
         is_long && !takes_hours(judgement.sets) ? "hours"
         : has_runs                              ? rough_time(judgement.seconds)
         : is_long                               ? "hours"
                                                 : kNothing,
         judgement.published, kind_of_measure(judgement) + measured_text(judgement), verdict});
  }
  return section;
}

Section items_section(const nlohmann::json& papers) {
  Section section = worded_section("items");
  section.tables = {worded_table("items-table"), worded_table("scripts-table")};
  Table &items = section.tables[0], &scripts = section.tables[1];
  for (const auto& item : papers.at("items"))
    items.rows.push_back({item.at("from").get<std::string>(), item.at("item").get<std::string>(),
                          item.at("state").get<std::string>(),
                          joined(item.at("by").get<std::vector<std::string>>())});
  for (const auto& script : papers.at("scripts")) {
    auto& row = scripts.rows.emplace_back();
    for (const char* key : {"script", "command", "time", "agrees"})
      row.emplace_back(script.at(key).get<std::string>());
  }
  return section;
}

Section claims_summary(const std::vector<Judgement>& judgements) {
  Section section = worded_section("claims-summary");
  section.readings = {{"", claims_reading(judgements)}};
  Table& table = section.tables.emplace_back(worded_table("claims-summary-table"));
  constexpr auto kDecided = static_cast<std::size_t>(Verdict::too_short);
  for (std::size_t i = 0; i < kVerdictNames.size(); ++i)
    for (const Judgement& judgement : judgements)
      if (judgement.verdict == static_cast<Verdict>(i < kDecided ? kDecided - 1 - i : i))
        table.rows.push_back({judgement.id, marked_verdict(judgement), judgement.published,
                              value_text(judgement), seeds_text(judgement)});
  return section;
}

}  // namespace isoline::reports
