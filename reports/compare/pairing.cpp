// Pairs cells by their identity, the strongest first, and describes differences of options and
// builds.
#include "reports/compare/pairing.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/spec.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

bool names(const std::string& pattern, const Given& given) {
  return matches(pattern, given.name) || matches(pattern, given.asked) ||
         matches(pattern, given.spec);
}

}  // namespace

// The star is the only wildcard: brackets belong to specifications.
bool matches(const std::string& pattern, const std::string& text) {
  std::string escaped;
  for (const char letter : pattern) {
    if (letter != '*') escaped += '\\';
    escaped += letter;
  }
  return ::fnmatch(escaped.c_str(), text.c_str(), 0) == 0;
}

AllowedList allowed_from_json(const Json& json) {
  try {
    require(json.at("schema") == kAllowedSchema,
            [&] { return fmt::format("the schema is not {}", kAllowedSchema); });
    AllowedList list;
    for (const Json& cells : json.at("cells")) {
      require(cells.contains("problem") || cells.contains("optimizer"),
              "an entry of the allowed cells must name a problem or an optimizer");
      list.push_back({.problem = cells.value("problem", std::string("*")),
                      .optimizer = cells.value("optimizer", std::string("*")),
                      .reason = cells.at("reason").get<std::string>(),
                      .is_of_criterion = cells.value("allows", std::string()) == "criterion"});
      require(!list.back().reason.empty(), "an entry of the allowed cells must give a reason");
    }
    return list;
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("not a valid {}: {}", kAllowedSchema, error.what()));
  }
}

AllowedList read_allowed(const std::filesystem::path& file) {
  return allowed_from_json(read_json(file));
}

AllowedList::const_iterator entry_for(const AllowedList& list, const ComparedCell& cell,
                                      bool is_of_criterion) {
  return std::ranges::find_if(list, [&](const AllowedCells& cells) {
    return cells.is_of_criterion == is_of_criterion && names(cells.problem, cell.problem) &&
           names(cells.optimizer, cell.optimizer);
  });
}

namespace {

using Unpaired = std::vector<const ComparedCell*>;  // nullptr where it is paired
using Identity = std::string (*)(const ComparedCell&);

std::string asked_pair(const ComparedCell& cell) {
  return fmt::format("{} × {}, seed {}", cell.problem.asked, cell.optimizer.asked, cell.seed);
}

constexpr Identity kIdentities[] = {
    [](const ComparedCell& cell) { return cell.key; },
    [](const ComparedCell& cell) { return asked_pair(cell) + cell.terms; },
    [](const ComparedCell& cell) {
      return fmt::format("{} × {}, seed {}{}", cell.problem.spec, cell.optimizer.spec, cell.seed,
                         cell.terms);
    },
    asked_pair};

// Where each identity stands; those that two share are nowhere.
std::map<std::string, std::size_t> places_of(const Unpaired& cells, Identity identity) {
  constexpr std::size_t kTwice = static_cast<std::size_t>(-1);
  std::map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] == nullptr) continue;
    const auto [at, is_first] = places.emplace(identity(*cells[i]), i);
    if (!is_first) at->second = kTwice;
  }
  std::erase_if(places,
                [](const auto& place) { return place.first.empty() || place.second == kTwice; });
  return places;
}

Unpaired addresses(const std::vector<ComparedCell>& cells) {
  Unpaired all;
  for (const ComparedCell& cell : cells) all.push_back(&cell);
  return all;
}

}  // namespace

Pairs paired(const std::vector<ComparedCell>& before, const std::vector<ComparedCell>& after) {
  Unpaired old = addresses(before), now = addresses(after), answer(old.size(), nullptr);
  for (const Identity identity : kIdentities) {
    const auto places = places_of(now, identity);
    for (const auto& [name, i] : places_of(old, identity)) {
      const auto at = places.find(name);
      if (at == places.end()) continue;
      answer[i] = now[at->second];
      old[i] = now[at->second] = nullptr;
    }
  }
  Pairs pairs;
  for (std::size_t i = 0; i < old.size(); ++i)
    if (answer[i] != nullptr)
      pairs.both.emplace_back(&before[i], answer[i]);
    else
      pairs.only_before.push_back(old[i]);
  std::ranges::copy_if(now, std::back_inserter(pairs.only_after),
                       [](const ComparedCell* cell) { return cell != nullptr; });
  return pairs;
}

namespace {

// "1e-4", "1e4", "0.9": the shorter of two ways.
std::string short_text(const OptionValue& value) {
  const Real* const number = std::get_if<Real>(&value);
  std::string plain = option_text(value);
  if (number == nullptr || !std::isfinite(*number) || *number == 0) return plain;
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(*number))));
  const std::string scientific = fmt::format(
      "{}e{}", std::stod(fmt::format("{:.15g}", *number * std::pow(10, -exponent))), exponent);
  return scientific.size() < plain.size() ? scientific : plain;
}

bool is_set_in(const std::string& spec, const std::string& option) {
  const Spec parsed = parse_spec(spec);
  return std::ranges::find(parsed.options, option, &std::pair<std::string, std::string>::first) !=
         parsed.options.end();
}

// An empty option equals one that did not exist yet.
bool says_nothing(const OptionValue* option) {
  return option == nullptr || option_text(*option).empty();
}

// Paired by what was asked, two differ in an option only by a default or by a table of rates.
std::string option_change_text(const Given& a, const Given& b, const std::string& option) {
  const OptionValue* const old = a.options->find(option);
  const OptionValue* const now = b.options->find(option);
  if (old == nullptr) return fmt::format("new option {} {}", option, short_text(*now));
  if (now == nullptr)
    return fmt::format("option {} was removed; it was {}", option, short_text(*old));
  const bool is_tabled = is_set_in(a.spec, option) && is_set_in(b.spec, option);
  return fmt::format("{} {} {} → {}", is_tabled ? "tabled" : "default of", option, short_text(*old),
                     short_text(*now));
}

void add_changes(const Given& a, const Given& b, std::set<std::string>& changes) {
  if (a.options == b.options) return;
  std::set<std::string> options;
  for (const OptionValues* values : {a.options.get(), b.options.get()})
    for (const NamedOption& each : *values) options.insert(each.name);
  for (const std::string& option : options) {
    const OptionValue* const old = a.options->find(option);
    const OptionValue* const now = b.options->find(option);
    if (old != nullptr && now != nullptr && *old == *now) continue;
    if (says_nothing(old) && says_nothing(now)) continue;
    changes.insert(a.name + ": " + option_change_text(a, b, option));
  }
}

// The members of the budget in "budget {"iterations":20}, threads 1", and the threads.
Json terms_json(const std::string& terms) {
  const std::size_t begin = terms.find('{'), end = terms.rfind('}');
  Json json = parse_json(terms.substr(begin, end - begin + 1), "terms");
  json["threads"] = std::stoi(terms.substr(terms.rfind(' ')));
  return json;
}

}  // namespace

std::string change_of_terms(const ComparedCell& before, const ComparedCell& after) {
  const Json old = terms_json(before.terms), now = terms_json(after.terms);
  Json both = old;
  both.update(now);
  const auto value_text = [](const Json& terms, const std::string& key) {
    return terms.contains(key) ? json_text(terms.at(key)) : std::string("no limit");
  };
  std::vector<std::string> changes;
  for (const auto& [key, value] : both.items())
    if (const auto was = value_text(old, key), is = value_text(now, key); was != is)
      changes.push_back(fmt::format("{} {} → {}", key, was, is));
  return joined(changes);
}

std::set<std::string> changed_options(const ComparedCell& before, const ComparedCell& after) {
  std::set<std::string> changes;
  add_changes(before.problem, after.problem, changes);
  add_changes(before.optimizer, after.optimizer, changes);
  return changes;
}

std::vector<std::string> changed_parts(const ComparedCell& before, const ComparedCell& after) {
  if (before.build == after.build) return {};
  std::vector<std::string> changes;
  for (const auto& [part, text] :
       {std::pair("platform", "another platform (compiler, flags, libraries or kernel)"),
        {"harness", "another harness (core, meter or run loop)"},
        {"problem", "another source of the problem"},
        {"network", "another source of the network"},
        {"optimizer", "another source of the optimizer"}}) {
    const auto old = before.parts->find(part), now = after.parts->find(part);
    if (old != before.parts->end() && now != after.parts->end() && old->second != now->second)
      changes.emplace_back(text);
  }
  if (changes.empty()) changes.emplace_back("another build");
  return changes;
}

std::string cause_of(const ComparedCell& before, const ComparedCell& after) {
  const std::set<std::string> options = changed_options(before, after);
  std::vector<std::string> causes(options.begin(), options.end());
  std::ranges::copy(changed_parts(before, after), std::back_inserter(causes));
  return causes.empty() ? "the same build and options" : joined(causes);
}

}  // namespace isoline::reports
