// Counts what is solved, by whom, and with how much work.
#include "reports/compare/trend.h"

#include <algorithm>
#include <map>

namespace isoline::reports {
namespace {

constexpr std::size_t kLeaders = 3;
constexpr Real kSolved = kTolerances.back().tau;

std::vector<HeadlineMethod> leaders_among(
    const std::map<std::string, std::vector<Real>>& works_of) {
  std::vector<HeadlineMethod> methods;
  for (const auto& [name, works] : works_of) {
    const auto solved = std::ranges::count_if(works, [](Real work) { return work < kNever; });
    methods.push_back({.name = name,
                       .solved = static_cast<std::size_t>(solved),
                       .runs = works.size(),
                       .median_work = median_of(works)});
  }
  std::ranges::stable_sort(methods, [](const HeadlineMethod& a, const HeadlineMethod& b) {
    return std::pair(b.solved, a.median_work) < std::pair(a.solved, b.median_work);
  });
  methods.resize(std::min(methods.size(), kLeaders));
  return methods;
}

}  // namespace

Headline headline_of(const std::string& label, const std::vector<Subject>& subjects) {
  Headline headline{.label = label, .leaders = {}};
  std::map<std::string, std::vector<Real>> works_of;
  for (const Subject& subject : subjects) {
    if (subject.state == name_of(Status::inapplicable)) continue;
    ++headline.runs;
    headline.failed += subject.lost;
    for (std::size_t t = 0; t < kTolerances.size(); ++t)
      headline.solved[t] += work_to(subject, subject.aim, kTolerances[t].tau) < kNever;
    works_of[subject.optimizer.name].push_back(work_to(subject, subject.aim, kSolved));
  }
  headline.leaders = leaders_among(works_of);
  return headline;
}

}  // namespace isoline::reports
