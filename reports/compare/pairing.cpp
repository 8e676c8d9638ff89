// Reads the list of cells that NEW may lack, and looks subjects up in it.
#include "reports/compare/pairing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

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

// Greedy, with one place to come back to: the last star, which takes one letter more each time.
bool matches(std::string_view pattern, std::string_view text) {
  std::size_t p = 0, t = 0, star = std::string_view::npos, taken = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++taken;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

AllowedList allowed_from_json(const Json& json) {
  try {
    require(json.at("schema") == kAllowedSchema,
            [&] { return fmt::format("the schema is not {}", kAllowedSchema); });
    AllowedList list;
    for (const Json& cells : json.at("cells")) {
      require(cells.contains("problem") || cells.contains("optimizer"),
              "an entry of the allowed cells names neither a problem nor an optimizer");
      list.push_back({.problem = cells.value("problem", std::string("*")),
                      .optimizer = cells.value("optimizer", std::string("*")),
                      .reason = cells.at("reason").get<std::string>()});
      require(!list.back().reason.empty(), "an entry of the allowed cells gives no reason");
    }
    return list;
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("no {}: {}", kAllowedSchema, error.what()));
  }
}

AllowedList read_allowed(const std::filesystem::path& file) {
  return allowed_from_json(read_json(file));
}

AllowedList::const_iterator entry_for(const AllowedList& list, const Subject& subject) {
  return std::ranges::find_if(list, [&](const AllowedCells& cells) {
    return names(cells.problem, subject.problem) && names(cells.optimizer, subject.optimizer);
  });
}

// Pairs subjects, by what identifies them best first.

namespace {

using Left = std::vector<const Subject*>;  // not paired yet; nullptr where it is
using Identity = std::string (*)(const Subject&);

std::string as_keyed(const Subject& subject) { return subject.key; }

std::string in_terms(const Subject& subject, const std::string& problem,
                     const std::string& optimizer) {
  return problem + " × " + optimizer + ", " + subject.terms;
}

std::string as_asked(const Subject& subject) {
  return in_terms(subject, subject.problem.asked, subject.optimizer.asked);
}

std::string as_given(const Subject& subject) {
  return in_terms(subject, subject.problem.spec, subject.optimizer.spec);
}

// Where each identity stands; those that two share are nowhere.
std::map<std::string, std::size_t> places_of(const Left& left, Identity identity) {
  constexpr std::size_t kTwice = static_cast<std::size_t>(-1);
  std::map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (left[i] == nullptr) continue;
    const auto [at, is_first] = places.emplace(identity(*left[i]), i);
    if (!is_first) at->second = kTwice;
  }
  std::erase_if(places,
                [](const auto& place) { return place.first.empty() || place.second == kTwice; });
  return places;
}

Left addresses(const std::vector<Subject>& subjects) {
  Left all;
  for (const Subject& subject : subjects) all.push_back(&subject);
  return all;
}

}  // namespace

Pairs paired(const std::vector<Subject>& before, const std::vector<Subject>& after) {
  Left old = addresses(before), now = addresses(after), answer(old.size(), nullptr);
  for (const Identity identity : {as_keyed, as_asked, as_given}) {
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
                       [](const Subject* subject) { return subject != nullptr; });
  return pairs;
}

// Holds the options and the builds of paired subjects to each other.

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

// An option of no text says what one that there was not yet said.
bool says_nothing(const OptionValue* option) {
  return option == nullptr || option_text(*option).empty();
}

// Paired by what was asked, two differ in an option only by a default or by a table of rates.
std::string change_text(const Given& a, const Given& b, const std::string& option) {
  const OptionValue* const old = a.options->find(option);
  const OptionValue* const now = b.options->find(option);
  if (old == nullptr) return fmt::format("new option {} {}", option, short_text(*now));
  if (now == nullptr) return fmt::format("option {} is gone, it was {}", option, short_text(*old));
  if (is_set_in(a.spec, option) && is_set_in(b.spec, option))
    return fmt::format("tabled {} {} → {}", option, short_text(*old), short_text(*now));
  return fmt::format("default of {} {} → {}", option, short_text(*old), short_text(*now));
}

void count_changes(const Given& a, const Given& b, std::map<std::string, std::size_t>& changes) {
  if (a.options == b.options) return;
  std::set<std::string> options;
  for (const OptionValues* values : {&*a.options, &*b.options})
    for (const NamedOption& each : *values) options.insert(each.name);
  for (const std::string& option : options) {
    const OptionValue* const old = a.options->find(option);
    const OptionValue* const now = b.options->find(option);
    if (old != nullptr && now != nullptr && *old == *now) continue;
    if (says_nothing(old) && says_nothing(now)) continue;
    ++changes[a.name + ": " + change_text(a, b, option)];
  }
}

// A part of a build, and how its change is told: of many cells, of one.
struct Part {
  const char *name, *text, *cause;
};
constexpr std::array<Part, 5> kParts = {
    {{"platform", "another platform (compiler, flags, libraries or kernel)", "another platform"},
     {"harness", "another harness (core, meter or run loop)", "another harness"},
     {"problem", "another source of the problems", "another source of the problem"},
     {"network", "another source of the networks of", "another source of the network"},
     {"optimizer", "another source of the optimizers", "another source of the optimizer"}}};

bool is_other(const Subject& a, const Subject& b, const Part& part) {
  const auto old = a.parts->find(part.name), now = b.parts->find(part.name);
  return old != a.parts->end() && now != b.parts->end() && old->second != now->second;
}

struct PartChange {
  std::set<std::string> names;  // of problems or optimizers, where it is theirs
  std::size_t cells = 0;
};

std::map<std::string, std::size_t> changes_between(const Subject& a, const Subject& b) {
  std::map<std::string, std::size_t> changes;
  count_changes(a.problem, b.problem, changes);
  count_changes(a.optimizer, b.optimizer, changes);
  return changes;
}

void count_parts(const Subject& a, const Subject& b, std::map<std::string, PartChange>& changes) {
  for (const Part& part : kParts) {
    if (!is_other(a, b, part)) continue;
    PartChange& change = changes[part.name];
    ++change.cells;
    const std::string name = part.name;
    if (name == "optimizer") change.names.insert(b.optimizer.name);
    if (name == "problem" || name == "network") change.names.insert(b.problem.name);
  }
}

}  // namespace

std::string cause_of(const Subject& before, const Subject& after) {
  std::vector<std::string> causes;
  for (const auto& [text, cells] : changes_between(before, after)) causes.push_back(text);
  if (before.builds != after.builds) {
    const std::size_t given = causes.size();
    for (const Part& part : kParts)
      if (is_other(before, after, part)) causes.emplace_back(part.cause);
    if (causes.size() == given) causes.emplace_back("another build");
  }
  return causes.empty() ? "the same build and options" : joined(causes);
}

std::string names_text(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 12;
  if (names.size() <= kMost) return joined(names);
  return fmt::format("{} and {} more", joined({names.begin(), names.begin() + kMost}),
                     names.size() - kMost);
}

std::vector<std::string> changed_settings(const Pairs& pairs) {
  std::map<std::string, std::size_t> changes;
  for (const auto& [a, b] : pairs.both)
    for (const auto& [text, cells] : changes_between(*a, *b)) changes[text] += cells;
  std::vector<std::string> lines;
  for (const auto& [text, cells] : changes)
    lines.push_back(fmt::format("{} ({})", text, counted(cells, "cell")));
  return lines;
}

std::vector<std::string> changed_builds(const Pairs& pairs) {
  std::map<std::string, PartChange> changes;
  std::size_t silent = 0;
  for (const auto& [a, b] : pairs.both) {
    if (a->builds == b->builds) continue;
    count_parts(*a, *b, changes);
    silent += a->parts->empty() || b->parts->empty();
  }
  std::vector<std::string> lines;
  for (const Part& part : kParts) {
    const auto at = changes.find(part.name);
    if (at == changes.end()) continue;
    const auto& [names, cells] = at->second;
    const std::string of = names.empty() ? "" : " " + names_text({names.begin(), names.end()});
    lines.push_back(fmt::format("{}{}: {}", part.text, of, counted(cells, "cell")));
  }
  if (silent > 0)
    lines.push_back(fmt::format("another build, whose parts a side does not tell: {}",
                                counted(silent, "cell")));
  return lines;
}

}  // namespace isoline::reports
