// The document as JSON, schema isoline.report/1: its sections, its plots by name, and all
// aggregates that they are made of. `figures` are the same for the same build, so that two reports
// can be compared; times are not, nor measured costs.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "core/files.h"
#include "core/json.h"
#include "reports/formats/formats.h"
#include "reports/sections/drawings.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// A list of what `item` makes of each.
template <class Range, class Item>
Json list_of(const Range& range, Item item) {
  Json list = Json::array();
  for (const auto& one : range) list.push_back(item(one));
  return list;
}

// An object with a value for each tolerance.
template <class Value>
Json by_tolerance(const Comparison& c, Value value) {
  Json json = Json::object();
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    json[std::string(c.yardstick.tolerances[t].name)] = value(t);
  return json;
}

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

// Raw counts until the tightest tolerance was met, of each run that met it, by oracle and seed.
Json calls_json(const Comparison& c, const Cell& cell) {
  std::array<std::vector<std::int64_t>, kOracles> calls;
  for (const std::size_t index : cell.runs) {
    const Run& run = c.runs[index];
    const Real work = c.taken(run, Measure::work, kTightest);
    if (work == kNever) continue;
    const OracleCounts counts = counts_at(*run.record, work);
    for (std::size_t kind = 0; kind < kOracles; ++kind) calls[kind].push_back(counts[kind]);
  }
  Json json = Json::object();
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (std::ranges::any_of(calls[kind], [](std::int64_t count) { return count != 0; }))
      json[std::string(kOracleNames[kind])] = calls[kind];
  return json;
}

// [cell, build, f_L, s, whether another row counts it, works to the tolerances] of each run: its
// record, and its success.
Json records_json(const Comparison& c, const Cell& cell) {
  return list_of(cell.runs, [&](std::size_t index) -> Json {
    const Run& run = c.runs[index];
    return Json::array(
        {run.record->cell, run.record->build, json_number(run.minimum), json_number(run.scale),
         run.is_repeated, by_tolerance(c, [&](std::size_t t) {
           return json_number(run.taken(Measure::work, c.yardstick.tolerances[t].rung));
         })});
  });
}

Json cell_json(const Comparison& c, std::size_t p, std::size_t s) {
  const Cell& cell = c.cell(p, s);
  std::set<std::string> asked, builds;  // requests, so that two reports compare like with like
  for (const std::size_t run : cell.runs) {
    asked.insert(c.runs[run].record->cell);
    builds.insert(c.runs[run].record->build);
  }
  Json json{{"problem", c.problems[p].spec},
            {"optimizer", c.optimizers[s].label},
            {"planned", cell.planned},
            {"runs", cell.runs.size()},
            {"failed", cell.failed},
            {"statuses", to_json(cell.statuses)},
            {"privileges", cell.privileges},
            {"asked", digest(joined({asked.begin(), asked.end()}, " "))},
            {"builds", builds},
            {"records", records_json(c, cell)}};
  if (!cell.inapplicable.empty()) json["inapplicable"] = cell.inapplicable;
  if (!cell.is_measured()) return json;
  const auto taken = [&](Measure by) {
    return by_tolerance(c, [&](std::size_t t) { return to_json(cell.taken[by][t]); });
  };
  json["figures"] = {{"work", taken(Measure::work)}, {"loss", to_json(cell.loss)}};
  if (cell.x_error.n > 0) json["figures"]["x_error"] = to_json(cell.x_error);
  json["costs"] = taken(Measure::cost);
  json["calls"] = calls_json(c, cell);
  json["times"] = {{"seconds", taken(Measure::time)}, {"timed_alone", cell.is_timed_alone}};
  return json;
}

Json profiles_json(const Comparison& c) {
  return by_tolerance(c, [&](std::size_t t) -> Json {
    const Profile& profile = c.profiles[t];
    Json lines = Json::object();
    for (std::size_t s = 0; s < profile.solvers.size(); ++s)
      lines[c.optimizers[s].label] = {{"problems", profile.solvers[s].problems},
                                      {"ratios", profile.solvers[s].ratios}};
    return {{"optimizers", lines}, {"reading", profile_reading(c, t)}};
  });
}

Json optimizer_json(const Comparison& c, const OptimizerAxis& optimizer) {
  const auto standing_json = [&](std::size_t t) -> Json {
    const Standing& standing = optimizer.standings[t];
    return {{"settings", standing.settings},
            {"solved", standing.solved},
            {"wins", standing.wins},
            {"reached", standing.reached},
            {"typical", json_number(standing.typical)},
            {"score", standing.score}};
  };
  return {{"optimizer", optimizer.label},       {"family", optimizer.family()},
          {"privileges", optimizer.privileges}, {"planned", optimizer.planned},
          {"applicable", optimizer.applicable}, {"runs", optimizer.runs},
          {"failed", optimizer.failed},         {"standings", by_tolerance(c, standing_json)}};
}

Json decision_json(const Comparison& c, const std::optional<Decision>& decision) {
  if (!decision) return nullptr;
  const auto place_json = [&](const results::Place& place) -> Json {
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
  };
  const auto choice_json = [&](const Choice& choice) -> Json {
    const auto label = [&](std::size_t s) { return c.optimizers[s].label; };
    return {{"choice", choice_text(choice)},
            {"first", list_of(choice.first, label)},
            {"kept", choice.is_kept}};
  };
  return {{"optimizer", c.optimizers[decision->places[0].method].label},
          {"tied", decision->tied},
          {"significant", decision->is_lead},
          {"settings", decision->settings},
          {"families", decision->families},
          {"friedman_p", decision->friedman},
          {"least_p", decision->least_p},
          {"places", list_of(decision->places, place_json)},
          {"choices", list_of(decision->choices, choice_json)}};
}

// [a, b, settings that both solve, a alone, b alone, neither, work of a over b, its interval]
Json pair_json(const Comparison& c, const MethodPair& pair) {
  return {
      c.optimizers[pair.a].label,  c.optimizers[pair.b].label, pair.ratio.both,   pair.ratio.only_a,
      pair.ratio.only_b,           pair.ratio.neither,         pair.ratio.median, pair.ratio.low,
      json_number(pair.ratio.high)};
}

Json failure_json(const Record& record) {
  return {{"cell", record.cell},
          {"status", name_of(record.status)},
          {"message", record.message},
          {"command", rerun_command(record.request)}};
}

Json audit_json(const Document& document) {
  Json json = audit_to_json(document.comparison.study->audits);
  json["readings"] =
      list_of(document.section("audit").readings, [](const Reading& reading) -> Json {
        return {{"property", reading.title}, {"sentence", reading.text}};
      });
  return json;
}

// Texts as every format prints them, and the numbers they are made of, by name.
Json table_json(const Table& table) {
  const auto text = [](const TableCell& cell) { return cell.text; };
  const auto numbers = [](const TableCell& cell) {
    Json named = Json::object();
    for (const auto& [name, value] : cell.numbers) named[name] = json_number(value);
    return named;
  };
  return {{"id", table.id},
          {"title", table.title},
          {"reading", table.reading},
          {"caption", table.caption},
          {"columns", table.columns},
          {"rows", list_of(table.rows, [&](const auto& row) { return list_of(row, text); })},
          {"values", list_of(table.rows, [&](const auto& row) { return list_of(row, numbers); })}};
}

Json line_json(const PlotSeries& line, const Comparison& c) {
  Json json{{"name", line.name}, {"x", json_numbers(line.x)}, {"y", json_numbers(line.y)}};
  if (line.optimizer) json["optimizer"] = c.optimizers[*line.optimizer].label;
  if (!line.method.empty()) {
    const Look look = look_of(line.method);
    json["dash"] = look.dash;
    json["marker"] = std::string(1, look.marker);
  }
  if (!line.low.empty()) json["low"] = json_numbers(line.low);
  if (!line.high.empty()) json["high"] = json_numbers(line.high);
  return json;
}

// A plot with the marks, axes and window that every drawing of it has.
Json plot_json(const NamedDrawing& one, const Document& document) {
  constexpr const char* kKinds[] = {"steps", "lines"};
  const Comparison& c = document.comparison;
  const Drawing& drawing = one.drawing;
  const Plot& plot = drawing.plot;
  const Window window = window_of(drawing);
  const auto lines = [&](const std::vector<PlotSeries>& all) {
    return list_of(all, [&](const PlotSeries& line) { return line_json(line, c); });
  };
  Json json{{"name", one.name},
            {"id", plot.id},
            {"kind", kKinds[static_cast<std::size_t>(plot.kind)]},
            {"join", kJoinNames[static_cast<std::size_t>(drawing.join)]},
            {"title", plot.title},
            {"reading", plot.reading},
            {"caption", plot.caption},
            {"x_label", plot.x_label},
            {"y_label", plot.y_label},
            {"log_x", plot.is_log_x},
            {"log_y", plot.is_log_y},
            {"window",
             json_numbers(std::array{window.x_low, window.x_high, window.y_low, window.y_high})},
            {"series", lines(plot.series)}};
  for (std::size_t i = 0; i < plot.series.size(); ++i)
    if (is_hidden(drawing, plot.series[i])) json["series"][i]["hidden"] = true;
  if (one.problem) json["problem"] = c.problems[*one.problem].spec;
  if (drawing.is_to_scale) json["to_scale"] = true;
  if (drawing.tolerance) json["goal"] = *drawing.tolerance * c.yardstick.tolerances[kTightest].tau;
  if (!plot.published.empty()) json["published"] = lines(plot.published);
  if (!drawing.ground.empty()) json["ground"] = lines(drawing.ground);
  if (!drawing.ends.empty()) json["ends"] = lines(drawing.ends);
  return json;
}

Json whole_section_json(const Section& section) {
  const auto reading_json = [](const Reading& one) -> Json {
    return {{"title", one.title}, {"text", one.text}};
  };
  return {
      {"id", section.id},
      {"title", section.title},
      {"lead", section.lead},
      {"readings", list_of(section.readings, reading_json)},
      {"tables", list_of(section.tables, table_json)},
      {"plots", list_of(section.plots, [](const Plot& plot) { return file_name_of(plot.id); })}};
}

Json problem_json(const ProblemAxis& problem) {
  Json json{{"problem", problem.spec}, {"name", problem.name}, {"group", problem.group()}};
  if (problem.has_own_sheet()) json["unknowns"] = problem.sheet->unknowns;
  return json;
}

Json measurement_json(const std::optional<Measurement>& measured) {
  if (!measured) return nullptr;
  return {{"value", json_number(measured->value)},
          {"low", json_number(measured->low)},
          {"high", json_number(measured->high)},
          {"n", measured->n}};
}

// The curves are in the records.
Json evidence_json(const Evidence& evidence) {
  if (evidence.terms.empty()) return nullptr;
  const auto run_json = [](const EvidenceRun& run) -> Json {
    return {{"cell", run.cell},
            {"record", run.file},
            {"seed", run.seed},
            {"figure", json_number(run.figure)},
            {"status", name_of(run.status)}};
  };
  const auto term_json = [&](const EvidenceTerm& term) -> Json {
    return {{"problem", term.problem},
            {"optimizer", term.optimizer},
            {"at", term.at},
            {"scale", term.scale},
            {"iteration", term.iteration ? Json(*term.iteration) : Json()},
            {"median", json_number(term.level)},
            {"runs", list_of(term.runs, run_json)}};
  };
  const auto printed_json = [](const PrintedRow& row) -> Json {
    return {{"iteration", row.iteration},
            {"printed", json_numbers(row.printed)},
            {"reached", json_numbers(row.reached)}};
  };
  return {{"kind", evidence.kind},
          {"column", evidence.column},
          {"published", json_number(evidence.published)},
          {"band", {json_number(evidence.band.low), json_number(evidence.band.high)}},
          {"terms", list_of(evidence.terms, term_json)},
          {"printed", list_of(evidence.printed, printed_json)}};
}

Json claim_json(const Judgement& judgement) {
  const auto set_json = [](const CellSet& set) -> Json {
    return {{"iterations", set.iterations},
            {"cells", set.planned},
            {"here", set.here},
            {"long", set.is_long},
            {"decides", set.is_deciding}};
  };
  Json json{{"id", judgement.id},
            {"sentence", judgement.sentence},
            {"source", judgement.source},
            {"quantity", judgement.quantity},
            {"published", judgement.published},
            {"fact", judgement.fact},
            {"verdict", name_of(judgement.verdict)},
            {"verification", judgement.is_verification},
            {"survives", judgement.survives},
            {"needs_iterations", judgement.needs},
            {"why", judgement.why},
            {"caveat", joined(judgement.caveats, " ")},
            {"measured", measurement_json(judgement.measured)},
            {"evidence", evidence_json(judgement.evidence)},
            {"sets", list_of(judgement.sets, set_json)},
            {"command", repeat_command(judgement.id, judgement.sets)}};
  for (const Contrast& contrast : judgement.contrasts)
    json["contrasts"].push_back({{"quantity", contrast.quantity},
                                 {"published", contrast.published},
                                 {"measured", measurement_json(contrast.measured)},
                                 {"evidence", evidence_json(contrast.evidence)}});
  for (const OtherReading& other : judgement.others)
    json["others"].push_back({{"how", other.how},
                              {"verdict", name_of(other.verdict)},
                              {"measured", measurement_json(other.measured)}});
  if (judgement.is_of_one_run && judgement.measured && judgement.measured->predicted)
    json["predicted"] = {json_number(judgement.measured->predicted->low),
                         json_number(judgement.measured->predicted->high)};
  return json;
}

}  // namespace

Json section_json(const Section& section) {
  return {{"title", section.title},
          {"readings", list_of(section.readings, [](const Reading& one) { return one.text; })},
          {"tables", list_of(section.tables, table_json)}};
}

Json claims_json(const std::vector<Judgement>& judgements) {
  return list_of(judgements, claim_json);
}

std::string json_of_runs(const Comparison& c) {
  Json cells = Json::array();
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      cells.push_back({{"problem", c.problems[p].spec},
                       {"optimizer", c.optimizers[s].label},
                       {"records", records_json(c, c.cell(p, s))}});
  return json_text({{"problems", list_of(c.problems, problem_json)}, {"cells", cells}});
}

std::string json_report(const Document& document) {
  const Comparison& c = document.comparison;
  Json cells = Json::array();
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).planned > 0) cells.push_back(cell_json(c, p, s));
  const auto missing_json = [](const PlannedCell& cell) -> Json {
    return {{"cell", cell.cell},
            {"problem", cell.problem},
            {"optimizer", cell.optimizer},
            {"seed", cell.seed}};
  };
  const auto unreadable_json = [](const Unreadable& file) -> Json {
    return {{"file", std::filesystem::path(file.file).filename().string()},
            {"reason", file.reason}};
  };
  const auto tolerance_json = [](const Tolerance& tolerance) -> Json {
    return {{"name", tolerance.name}, {"tau", tolerance.tau}};
  };
  Json json{
      {"schema", "isoline.report/1"},
      {"headline", document.headline},
      {"version", version_text(c)},
      {"suites", c.study->plan.suites},
      {"planned", c.planned},
      {"answered", c.answered},
      {"missing", list_of(c.missing, missing_json)},
      {"statuses", to_json(c.statuses)},
      {"seeds", c.seeds},
      {"superseded", c.study->superseded},
      {"unreadable", list_of(c.study->unreadable, unreadable_json)},
      {"failures",
       list_of(c.failures, [&](std::size_t run) { return failure_json(*c.runs[run].record); })},
      {"yardstick",
       {{"by", name_of(c.yardstick.by)},
        {"tolerances", list_of(c.yardstick.tolerances, tolerance_json)}}},
      {"verdict", list_of(document.section("standings").readings,
                          [](const Reading& reading) { return reading.text; })},
      {"claims", claims_json(document.claims)},
      {"audit", audit_json(document)},
      {"ranked", list_of(c.order.settings, [&](std::size_t p) { return c.problems[p].spec; })},
      {"leader", decision_json(c, c.decision)},
      {"open_leader", decision_json(c, c.open_decision)},
      {"optimizers",
       list_of(c.optimizers, [&](const OptimizerAxis& one) { return optimizer_json(c, one); })},
      {"pairs", list_of(all_pairs(c), [&](const MethodPair& pair) { return pair_json(c, pair); })},
      {"profiles", profiles_json(c)},
      {"cost_unit", cost_unit(c)},
      {"problems", list_of(c.problems, problem_json)},
      {"sections", list_of(document.sections, whole_section_json)},
      {"plots", list_of(drawings_of(document),
                        [&](const NamedDrawing& one) { return plot_json(one, document); })},
      {"cells", std::move(cells)}};
  // A line per cell, section and plot: an indent per number would double the file.
  std::string text;
  for (const auto& [key, value] : json.items()) {
    text += (text.empty() ? "{\n" : ",\n") + json_text(key) + ": ";
    if (!value.is_array()) {
      text += json_text(value);
      continue;
    }
    std::vector<std::string> lines;
    for (const Json& one : value) lines.push_back(json_text(one));
    text += lines.empty() ? "[]" : "[\n" + joined(lines, ",\n") + "\n]";
  }
  return text + "\n}\n";
}

}  // namespace isoline::reports
