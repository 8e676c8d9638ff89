// Sections as JSON: the tables and plots of the statistics, and the verdicts on claims.
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/formats/formats.h"
#include "reports/sections/evidence.h"

namespace isoline::reports {
namespace {

// Texts as every format prints them, and the numbers they are made of, by name.
Json table_json(const Table& table) {
  Json rows = Json::array(), values = rows;
  for (const auto& row : table.rows) {
    Json texts = Json::array();
    Json numbers = Json::array();
    for (const TableCell& cell : row) {
      texts.push_back(cell.text);
      Json named = Json::object();
      for (const auto& [name, value] : cell.numbers) named[name] = json_number(value);
      numbers.push_back(std::move(named));
    }
    rows.push_back(std::move(texts));
    values.push_back(std::move(numbers));
  }
  return {{"id", table.id},           {"title", table.title},     {"reading", table.reading},
          {"caption", table.caption}, {"columns", table.columns}, {"rows", rows},
          {"values", values}};
}

Json plot_json(const Plot& plot, const Comparison& c) {
  constexpr const char* kKinds[] = {"steps", "dots", "bars", "lines"};
  const auto numbers = [](const std::vector<Real>& values) { return json_numbers(values); };
  Json rows = Json::array(), series = Json::array();
  for (const PlotRow& row : plot.rows) rows.push_back(row.name);
  for (const PlotSeries& one : plot.series)
    series.push_back({{"optimizer", c.optimizers[one.optimizer.value()].label},
                      {"name", one.name},
                      {"x", numbers(one.x)},
                      {"y", numbers(one.y)},
                      {"low", numbers(one.low)},
                      {"high", numbers(one.high)}});
  return {{"id", plot.id},
          {"kind", kKinds[static_cast<std::size_t>(plot.kind)]},
          {"title", plot.title},
          {"reading", plot.reading},
          {"caption", plot.caption},
          {"x_label", plot.x_label},
          {"y_label", plot.y_label},
          {"log_x", plot.is_log_x},
          {"rows", rows},
          {"series", series}};
}

Json measurement_json(const std::optional<Measurement>& measured) {
  if (!measured) return nullptr;
  return {{"value", json_number(measured->value)},
          {"low", json_number(measured->low)},
          {"high", json_number(measured->high)},
          {"n", measured->n}};
}

Json band_json(const Agreement& band) { return {json_number(band.low), json_number(band.high)}; }

Json runs_json(const EvidenceTerm& term) {
  Json runs = Json::array();
  for (const EvidenceRun& run : term.runs)
    runs.push_back({{"cell", run.cell},
                    {"record", run.file},
                    {"seed", run.seed},
                    {"figure", json_number(run.figure)},
                    {"status", std::string(name_of(run.status))}});
  return runs;
}

// The curves are in the records.
Json evidence_json(const Evidence& evidence) {
  if (evidence.terms.empty()) return nullptr;
  Json terms = Json::array(), printed = terms;
  for (const EvidenceTerm& term : evidence.terms) {
    Json json{{"problem", term.problem}, {"optimizer", term.optimizer},
              {"at", term.at},           {"scale", term.scale},
              {"iteration", nullptr},    {"median", json_number(term.level)},
              {"runs", runs_json(term)}};
    if (term.iteration) json["iteration"] = *term.iteration;
    terms.push_back(std::move(json));
  }
  for (const PrintedRow& row : evidence.printed)
    printed.push_back({{"iteration", row.iteration},
                       {"printed", json_numbers(row.printed)},
                       {"reached", json_numbers(row.reached)}});
  return {{"kind", evidence.kind},
          {"column", evidence.column},
          {"published", json_number(evidence.published)},
          {"band", band_json(evidence.band)},
          {"terms", terms},
          {"printed", printed}};
}

Json sets_json(const std::vector<CellSet>& sets) {
  Json list = Json::array();
  for (const CellSet& set : sets)
    list.push_back({{"iterations", set.iterations},
                    {"cells", set.planned},
                    {"here", set.here},
                    {"long", set.is_long},
                    {"decides", set.is_deciding}});
  return list;
}

}  // namespace

Json statistics_json(const Document& document) {
  const Section& section = document.section("statistics");
  Json limits = Json::array(), tables = Json::array(), plots = Json::array();
  for (const Reading& limit : section.readings) limits.push_back(limit.text);
  for (const Table& one : section.tables) tables.push_back(table_json(one));
  for (const Plot& plot : section.plots) plots.push_back(plot_json(plot, document.comparison));
  return {{"limits", limits},
          {"cost_unit", cost_unit(document.comparison)},
          {"tables", tables},
          {"plots", plots}};
}

Json claims_json(const std::vector<Judgement>& judgements) {
  Json list = Json::array();
  for (const Judgement& judgement : judgements) {
    Json json{{"id", judgement.id},
              {"sentence", judgement.sentence},
              {"source", judgement.source},
              {"quantity", judgement.quantity},
              {"published", judgement.published},
              {"fact", judgement.fact},
              {"verdict", std::string(name_of(judgement.verdict))},
              {"survives", judgement.survives},
              {"needs_iterations", judgement.needs},
              {"why", judgement.why},
              {"caveat", judgement.caveat},
              {"measured", measurement_json(judgement.measured)},
              {"evidence", evidence_json(judgement.evidence)},
              {"sets", sets_json(judgement.sets)},
              {"command", repeat_command(judgement.id, judgement.sets)}};
    if (const auto& contrast = judgement.contrast)
      json["contrast"] = {{"quantity", contrast->quantity},
                          {"published", contrast->published},
                          {"measured", measurement_json(contrast->measured)},
                          {"evidence", evidence_json(contrast->evidence)}};
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace isoline::reports
