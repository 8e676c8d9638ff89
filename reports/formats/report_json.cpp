// All aggregates as JSON, schema isoline.report/1. `figures` are the same for the same build, so
// that two reports can be compared; times are not, nor measured costs.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "core/digest.h"
#include "core/json.h"
#include "reports/formats/formats.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

Json to_json(const Spread& spread) {
  return {{"median", json_number(spread.median)},
          {"low", json_number(spread.low)},
          {"high", json_number(spread.high)},
          {"n", spread.n},
          {"unsolved", spread.unsolved}};
}

Json to_json(const std::map<Status, std::size_t>& statuses) {
  Json json = Json::object();
  for (const auto& [status, count] : statuses) json[std::string(name_of(status))] = count;
  return json;
}

Json by_tolerance(const Comparison& c, const Cell& cell, Measure by) {
  Json json = Json::object();
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    json[std::string(c.yardstick.tolerances[t].name)] = to_json(cell.taken[by][t]);
  return json;
}

// Which requests stand behind a pair, so that two reports compare like with like.
std::string asked_digest(const Comparison& c, const Cell& cell) {
  std::set<std::string> cells;
  for (const std::size_t run : cell.runs) cells.insert(c.runs[run].record->cell);
  return digest(joined({cells.begin(), cells.end()}, " "));
}

std::set<std::string> builds_of(const Comparison& c, const Cell& cell) {
  std::set<std::string> builds;
  for (const std::size_t run : cell.runs) builds.insert(c.runs[run].record->build);
  return builds;
}

// Raw counts until the tightest tolerance was met, of each run that met it, by oracle and seed.
Json calls_json(const Comparison& c, const Cell& cell) {
  Json json = Json::object();
  for (const std::size_t index : cell.runs) {
    const Run& run = c.runs[index];
    const Real work = c.taken(run, Measure::work, kTightest);
    if (work == kNever) continue;
    const OracleCounts counts = counts_at(*run.record, work);
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      json[std::string(kOracleNames[kind])].push_back(counts[kind]);
  }
  for (auto it = json.begin(); it != json.end();)
    if (std::ranges::all_of(*it, [](const Json& count) { return count == 0; }))
      it = json.erase(it);
    else
      ++it;
  return json;
}

Json cell_json(const Comparison& c, std::size_t p, std::size_t s) {
  const Cell& cell = c.cell(p, s);
  Json json{{"problem", c.problems[p].spec}, {"optimizer", c.optimizers[s].label},
            {"planned", cell.planned},       {"runs", cell.runs.size()},
            {"failed", cell.failed},         {"statuses", to_json(cell.statuses)},
            {"privileges", cell.privileges}, {"asked", asked_digest(c, cell)},
            {"builds", builds_of(c, cell)}};
  if (!cell.inapplicable.empty()) json["inapplicable"] = cell.inapplicable;
  if (!cell.is_measured()) return json;
  json["figures"] = {{"work", by_tolerance(c, cell, Measure::work)}, {"loss", to_json(cell.loss)}};
  if (cell.x_error.n > 0) json["figures"]["x_error"] = to_json(cell.x_error);
  json["costs"] = by_tolerance(c, cell, Measure::cost);
  json["calls"] = calls_json(c, cell);
  json["times"] = {{"seconds", by_tolerance(c, cell, Measure::time)},
                   {"timed_alone", cell.is_timed_alone}};
  return json;
}

Json profiles_json(const Comparison& c) {
  Json json = Json::object();
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    const Profile& profile = c.profiles[t];
    Json lines = Json::object();
    for (std::size_t s = 0; s < profile.solvers.size(); ++s)
      lines[c.optimizers[s].label] = {{"problems", profile.solvers[s].problems},
                                      {"ratios", profile.solvers[s].ratios}};
    json[std::string(c.yardstick.tolerances[t].name)] = {{"optimizers", lines},
                                                         {"reading", profile_reading(c, t)}};
  }
  return json;
}

Json standing_json(const Standing& standing) {
  return {{"settings", standing.settings},
          {"solved", standing.solved},
          {"wins", standing.wins},
          {"reached", standing.reached},
          {"typical", json_number(standing.typical)},
          {"score", standing.score}};
}

// Best first.
Json standings_json(const Comparison& c) {
  Json list = Json::array();
  for (const OptimizerAxis& optimizer : c.optimizers) {
    Json json{{"optimizer", optimizer.label},       {"family", optimizer.family()},
              {"privileges", optimizer.privileges}, {"planned", optimizer.planned},
              {"applicable", optimizer.applicable}, {"runs", optimizer.runs},
              {"failed", optimizer.failed}};
    for (std::size_t t = 0; t < kTolerances.size(); ++t)
      json["standings"][std::string(c.yardstick.tolerances[t].name)] =
          standing_json(optimizer.standings[t]);
    list.push_back(std::move(json));
  }
  return list;
}

Json labels_json(const Comparison& c, const std::vector<std::size_t>& methods) {
  Json list = Json::array();
  for (const std::size_t s : methods) list.push_back(c.optimizers[s].label);
  return list;
}

Json place_json(const Comparison& c, const results::Place& place) {
  return {{"optimizer", c.optimizers[place.method].label},
          {"score", place.score},
          {"low", json_number(place.interval.low)},
          {"high", json_number(place.interval.high)},
          {"solved", place.solved},
          {"p", place.p},
          {"adjusted_p", place.adjusted},
          {"in_group", place.is_in_group},
          {"share_first", place.share_first},
          {"work_ratio", json_number(place.ratio.median)},
          {"both_solve", place.ratio.both}};
}

Json decision_json(const Comparison& c, const std::optional<Decision>& decision) {
  if (!decision) return nullptr;
  Json places = Json::array(), choices = places;
  for (const results::Place& place : decision->places) places.push_back(place_json(c, place));
  for (const Choice& choice : decision->choices)
    choices.push_back({{"choice", choice_text(choice)},
                       {"first", labels_json(c, choice.first)},
                       {"kept", choice.is_kept}});
  return {{"optimizer", c.optimizers[decision->places[0].method].label},
          {"tied", decision->tied},
          {"significant", decision->is_lead},
          {"settings", decision->settings},
          {"families", decision->families},
          {"friedman_p", decision->friedman},
          {"least_p", decision->least_p},
          {"places", places},
          {"choices", choices}};
}

// [a, b, wins, losses, ties, neither, typical, its interval]
Json pairs_json(const Comparison& c) {
  Json list = Json::array();
  for (const MethodPair& pair : all_pairs(c)) {
    const auto [low, high] = pair.pairing.interval();
    list.push_back({c.optimizers[pair.a].label, c.optimizers[pair.b].label, pair.pairing.wins,
                    pair.pairing.losses, pair.pairing.ties, pair.pairing.neither,
                    pair.pairing.typical(), low, high});
  }
  return list;
}

Json missing_json(const Comparison& c) {
  Json list = Json::array();
  for (const PlannedCell& cell : c.missing)
    list.push_back({{"cell", cell.cell},
                    {"problem", cell.problem},
                    {"optimizer", cell.optimizer},
                    {"seed", cell.seed}});
  return list;
}

Json failures_json(const Comparison& c) {
  Json list = Json::array();
  for (const std::size_t run : c.failures) {
    const Record& record = *c.runs[run].record;
    list.push_back({{"cell", record.cell},
                    {"status", name_of(record.status)},
                    {"message", record.message},
                    {"command", rerun_command(record.request)}});
  }
  return list;
}

Json audit_json(const Document& document) {
  Json json = audit_to_json(document.comparison.study->audits);
  json["readings"] = Json::array();
  for (const Reading& reading : document.section("audit").readings)
    json["readings"].push_back({{"property", reading.title}, {"sentence", reading.text}});
  return json;
}

Json yardstick_json(const Yardstick& yardstick) {
  Json tolerances = Json::array();
  for (const Tolerance& tolerance : yardstick.tolerances)
    tolerances.push_back({{"name", tolerance.name}, {"tau", tolerance.tau}});
  return {{"by", name_of(yardstick.by)}, {"tolerances", tolerances}};
}

Json verdict_json(const Document& document) {
  Json sentences = Json::array();
  for (const Reading& reading : document.section("standings").readings)
    sentences.push_back(reading.text);
  return sentences;
}

}  // namespace

std::string json_report(const Document& document) {
  const Comparison& c = document.comparison;
  Json cells = Json::array(), unreadable = Json::array();
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).planned > 0) cells.push_back(cell_json(c, p, s));
  for (const Unreadable& file : c.study->unreadable)
    unreadable.push_back(
        {{"file", std::filesystem::path(file.file).filename().string()}, {"reason", file.reason}});
  const Json json{{"schema", kReportSchema},
                  {"suites", c.study->plan.suites},
                  {"planned", c.planned},
                  {"answered", c.answered},
                  {"missing", missing_json(c)},
                  {"statuses", to_json(c.statuses)},
                  {"seeds", c.seeds},
                  {"superseded", c.study->superseded},
                  {"unreadable", unreadable},
                  {"failures", failures_json(c)},
                  {"yardstick", yardstick_json(c.yardstick)},
                  {"verdict", verdict_json(document)},
                  {"claims", claims_json(document.claims)},
                  {"audit", audit_json(document)},
                  {"leader", decision_json(c, c.decision)},
                  {"open_leader", decision_json(c, c.open_decision)},
                  {"optimizers", standings_json(c)},
                  {"pairs", pairs_json(c)},
                  {"profiles", profiles_json(c)},
                  {"statistics", statistics_json(document)},
                  {"cells", cells}};
  return json_text(json, 1) + "\n";
}

// Sections as JSON: the tables and plots of the statistics, and the verdicts on claims.

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
              {"verification", judgement.is_verification},
              {"survives", judgement.survives},
              {"needs_iterations", judgement.needs},
              {"why", judgement.why},
              {"caveat", judgement.caveat},
              {"measured", measurement_json(judgement.measured)},
              {"evidence", evidence_json(judgement.evidence)},
              {"sets", sets_json(judgement.sets)},
              {"command", repeat_command(judgement.id, judgement.sets)}};
    for (const Contrast& contrast : judgement.contrasts)
      json["contrasts"].push_back({{"quantity", contrast.quantity},
                                   {"published", contrast.published},
                                   {"measured", measurement_json(contrast.measured)},
                                   {"evidence", evidence_json(contrast.evidence)}});
    for (const OtherReading& other : judgement.others)
      json["others"].push_back({{"how", other.how},
                                {"verdict", std::string(name_of(other.verdict))},
                                {"measured", measurement_json(other.measured)}});
    if (judgement.is_of_one_run && judgement.measured && judgement.measured->predicted)
      json["predicted"] = {json_number(judgement.measured->predicted->low),
                           json_number(judgement.measured->predicted->high)};
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace isoline::reports
