// Pairs subjects, by what identifies them best first.
#include "reports/compare/pairing.h"

#include <algorithm>
#include <map>
#include <string>

namespace isoline::reports {
namespace {

using Left = std::vector<const Subject*>;  // not paired yet; nullptr where it is
using Identity = std::string (*)(const Subject&);

std::string as_keyed(const Subject& subject) { return subject.key; }

std::string in_terms(const Subject& subject, const std::string& problem,
                     const std::string& optimizer) {
  return subject.terms.empty() ? "" : problem + " × " + optimizer + ", " + subject.terms;
}

std::string as_asked(const Subject& subject) {
  return in_terms(subject, subject.problem.asked, subject.optimizer.asked);
}

std::string as_given(const Subject& subject) {
  return in_terms(subject, subject.problem.spec, subject.optimizer.spec);
}

std::string as_titled(const Subject& subject) { return subject.title; }

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
  for (const Identity identity : {as_keyed, as_asked, as_given, as_titled}) {
    const auto places = places_of(now, identity);
    for (const auto& [name, i] : places_of(old, identity)) {
      const auto at = places.find(name);
      if (at == places.end()) continue;
      const Subject* const other = now[at->second];
      // Titles are silent about budgets: where both sides tell theirs, they are others.
      if (identity == as_titled && !old[i]->terms.empty() && !other->terms.empty()) continue;
      answer[i] = other;
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

}  // namespace isoline::reports
