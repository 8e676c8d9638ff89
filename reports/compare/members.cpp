// The differences of two records beyond the compared figures: every member of theirs, number by
// number, with or without a tolerance; and which members a comparison cannot judge.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "reports/compare/gate.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// Members that are no results, or that other parts of a comparison judge.
const std::set<std::string> kJudgedElsewhere = {"build",  "build_parts", "cell",
                                                "schema", "status",      "request"};
// Texts that may hold numbers and addresses of one machine: a change is named, and is not worse.
const std::set<std::string> kTexts = {"claimed", "message"};
// Arrays beside the path of a run: as long as that is.
const std::set<std::string> kPathMembers = {"curve", "exhibit", "hits", "series", "trajectory"};

constexpr Real kRounding = 1e-15;  // of double precision, as a share of a column

bool is_number(const Json& value) {
  return value.is_number() || value.is_null() ||
         (value.is_string() && (value == "inf" || value == "-inf" || value == "nan"));
}
Real number_of(const Json& value) { return value.is_null() ? std::nan("") : real_of(value); }

// Digests follow from numbers that are compared, and another platform rounds those.
bool is_digest(const std::string& name) { return name == "digest" || name == "criterion"; }

class Walk {
 public:
  Walk(const std::optional<Real>& tolerance, Real x_scale)
      : tolerance_(tolerance), x_scale_(x_scale) {}

  // The first place that differs, with both values; empty where none does.
  struct Place {
    std::string name, before, after;
  };
  std::optional<Place> first;
  bool is_longer = false;  // a column of numbers has another length

  void compare(const Json& a, const Json& b, const std::string& name) {
    if (first) return;
    if (a.is_object() && b.is_object()) return objects(a, b, name);
    if (a.is_array() && b.is_array()) return arrays(a, b, name);
    if (is_number(a) && is_number(b)) {
      const Real before = number_of(a), after = number_of(b);
      if (!agree(before, after, std::max(std::abs(before), std::abs(after))))
        differ(name, exact_figure(before), exact_figure(after));
      return;
    }
    if (a == b) return;
    const bool is_told = tolerance_ && is_digest(last_of(name)) && a.is_string() && b.is_string();
    if (!is_told || a.get<std::string>().empty() != b.get<std::string>().empty())
      differ(name, short_text(a), short_text(b));
  }

 private:
  static std::string last_of(const std::string& name) { return name.substr(name.rfind(' ') + 1); }
  static std::string short_text(const Json& value) {
    constexpr std::size_t kMost = 40;
    const std::string text = value.is_string() ? value.get<std::string>() : json_text(value);
    return text.size() > kMost ? text.substr(0, kMost) + "…" : text;
  }
  void differ(const std::string& name, std::string before, std::string after) {
    first = {name, std::move(before), std::move(after)};
  }

  bool agree(Real a, Real b, Real unit) const {
    if (a == b || (std::isnan(a) && std::isnan(b))) return true;
    return tolerance_ && std::isfinite(a) && std::isfinite(b) &&
           std::abs(a - b) <= (*tolerance_ + kRounding) * unit;
  }

  void objects(const Json& a, const Json& b, const std::string& name) {
    for (const auto& [key, value] : a.items()) {
      const std::string inner = name + " " + key;
      if (!b.contains(key))
        differ(inner, "known", "gone");
      else
        compare(value, b.at(key), inner);
    }
    if (!tolerance_)
      for (const auto& [key, value] : b.items())
        if (!first && !a.contains(key)) differ(name + " " + key, "none", short_text(value));
  }

  // Numbers of one column have one unit: the largest of them, or of x the norm of the solution.
  // Standard deviations have units of their own.
  void arrays(const Json& a, const Json& b, const std::string& name) {
    if (a.size() != b.size()) {
      is_longer = true;
      return differ(name, counted(a.size(), "value"), counted(b.size(), "value"));
    }
    Real unit = 0;
    for (const Json* side : {&a, &b})
      for (const Json& value : *side)
        if (const Real size = is_number(value) ? std::abs(number_of(value)) : 0;
            std::isfinite(size))
          unit = std::max(unit, size);
    const bool is_x = name.ends_with(" x") && x_scale_ > 0;
    const bool is_own = name.ends_with(" standard_deviation");
    for (std::size_t i = 0; i < a.size() && !first; ++i) {
      if (!is_number(a[i]) || !is_number(b[i])) {
        compare(a[i], b[i], name);
        continue;
      }
      const Real before = number_of(a[i]), after = number_of(b[i]);
      if (!agree(before, after, is_x ? x_scale_ : is_own ? std::abs(before) : unit))
        differ(name, exact_figure(before), exact_figure(after));
    }
  }

  const std::optional<Real>& tolerance_;
  Real x_scale_;
};

Json members_of(const std::string& file) {
  Record record = read_unchecked_record(file);
  if (record.answer && record.answer->is_in_file()) {
    read_answer_numbers(*record.answer, answer_path(file));
    record.answer->digest.clear();
  }
  Json json = result_of(to_json(record));
  json.update(members_beside_results(record));
  return json;
}

std::string shown_name(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

}  // namespace

Json members_beside_results(const Record& record) {
  Json json = Json::object();
  json["rates"] = record.request.rates;
  if (record.fields) json["snapshots"] = record.fields->digest;
  if (record.hits) json["hit_counts"] = record.hits->counts;
  if (record.x_hits) json["x_hit_counts"] = record.x_hits->counts;
  return json;
}

Differences member_differences(const ComparedCell& a, const ComparedCell& b,
                               const std::optional<Real>& tolerance,
                               std::set<std::string>& uncompared) {
  Json before, after;
  try {
    before = members_of(a.file);
    after = members_of(b.file);
  } catch (const UsageError& error) {  // a file of numbers is missing, or is damaged
    return {difference_in(a, Change::worse, "record", "whole", error.what())};
  }
  if (tolerance)  // compared as figures, with the rounding of their scale
    for (const char* figure : {"best_loss", "loss", "x_error"}) before.at("summary").erase(figure);
  Differences all;
  for (const auto& [name, value] : after.items()) {  // which a later program may write
    if (before.contains(name) || kJudgedElsewhere.contains(name) || name == "snapshots" ||
        is_digest(name))
      continue;
    if (a.build == b.build)
      all.push_back(difference_in(a, Change::worse, shown_name(name), "none", "known"));
    else
      uncompared.insert(shown_name(name));
  }
  const auto length_of = [](const Json& json) { return json.at("curve").at("iteration").size(); };
  const bool is_as_long = length_of(before) == length_of(after);
  for (const auto& [name, value] : before.items()) {
    if (kJudgedElsewhere.contains(name)) continue;
    if (tolerance && (kTexts.contains(name) || name == "snapshots")) {
      if (!after.contains(name) || value != after.at(name)) uncompared.insert(shown_name(name));
      continue;
    }
    const bool is_path = kPathMembers.contains(name);
    if (tolerance && is_path && !is_as_long) {
      uncompared.insert(shown_name(name));
      continue;
    }
    if (!after.contains(name)) {
      if (name != "snapshots")
        all.push_back(difference_in(a, Change::worse, shown_name(name), "known", "gone"));
      continue;
    }
    Walk walk(tolerance, a.x_scale);
    walk.compare(value, after.at(name), name);
    if (!walk.first) continue;
    const bool is_change = kTexts.contains(name);
    all.push_back(
        difference_in(a, is_change ? Change::changed : Change::worse,
                      shown_name(is_path || kTexts.contains(name) ? name : walk.first->name),
                      walk.first->before, walk.first->after));
    if (is_path) all.back().note = shown_name(walk.first->name) + "; the path differs";
  }
  return all;
}

// The plan and the table of rates of a folder that NEW lacks or has otherwise.
std::string folder_lack(const std::filesystem::path& before, const std::filesystem::path& after,
                        const std::set<std::string>& specs) {
  std::vector<std::string> lacks;
  const auto planned = [](const std::filesystem::path& folder) {
    std::set<std::string> cells;
    if (const auto file = folder / "plan.json"; is_there(file))
      for (const PlannedCell& cell : plan_from_text(read_text(file), file.string()).cells)
        cells.insert(cell.cell);
    return cells;
  };
  const std::set<std::string> old = planned(before), now = planned(after);
  const auto gone =
      std::ranges::count_if(old, [&](const auto& cell) { return !now.contains(cell); });
  if (gone > 0)
    lacks.push_back(
        fmt::format("the plan of NEW lacks {} of {}", gone, counted(old.size(), "cell")));
  const auto rates = [](const std::filesystem::path& folder) {  // a row each; NEW may have more
    std::set<std::string> rows;
    if (const auto file = folder / "rates.json"; is_there(file))
      for (const Json& row :
           parse_json(read_text(file), file.string()).value("rows", Json::array()))
        rows.insert(json_text(row));
    return rows;
  };
  const std::set<std::string> rows = rates(before), rows_now = rates(after);
  if (is_there(before / "rates.json") && !is_there(after / "rates.json"))
    lacks.emplace_back("rates.json of NEW is missing");
  else if (!std::ranges::includes(rows_now, rows))
    lacks.emplace_back("rates.json of NEW differs");
  std::size_t declared = 0;  // files of problems that say otherwise by what they are judged
  std::size_t missing = 0;   // of what NEW has runs of
  const auto member = [](const Json& of, const char* which) {
    return of.is_object() ? of.value(which, Json()) : Json();
  };
  const auto spec_of = [&](const Json& of) {
    const Json spec = member(of, "spec");
    return spec.is_string() ? spec.get<std::string>() : "";
  };
  std::set<std::string> described;
  if (is_there(after / "components"))
    for (const std::string& name : names_in(after / "components"))
      described.insert(spec_of(read_json(after / "components" / name)));
  if (is_there(before / "components"))
    for (const std::string& name : names_in(before / "components")) {
      const Json a = read_json(before / "components" / name);
      missing += specs.contains(spec_of(a)) && !described.contains(spec_of(a));
      if (!is_there(after / "components" / name)) continue;
      const Json b = read_json(after / "components" / name);
      declared += std::ranges::any_of(
          std::array{"family", "linear", "group", "unknowns", "residuals"},
          [&](const char* which) { return member(a, which) != member(b, which); });
    }
  if (declared > 0)
    lacks.push_back(fmt::format("{} of NEW differ in family, kind or size",
                                counted(declared, "component file")));
  if (missing > 0) lacks.push_back(fmt::format("NEW lacks {}", counted(missing, "component file")));
  return joined(lacks, "; ");
}

}  // namespace isoline::reports
