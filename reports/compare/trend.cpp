// Counts what is solved, by whom, and with how much work.
#include "reports/compare/trend.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "reports/compare/baseline.h"

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

Json headline_json(const Headline& headline) {
  Json leaders = Json::array();
  for (const HeadlineMethod& method : headline.leaders)
    leaders.push_back({{"optimizer", method.name},
                       {"solved", method.solved},
                       {"runs", method.runs},
                       {"median_work", json_number(method.median_work)}});
  return {{"runs", headline.runs},
          {"failed", headline.failed},
          {"solved", headline.solved},
          {"leaders", std::move(leaders)}};
}

Headline headline_from_json(const std::string& label, const Json& json) {
  Headline headline{.label = label, .leaders = {}};
  json.at("runs").get_to(headline.runs);
  json.at("failed").get_to(headline.failed);
  json.at("solved").get_to(headline.solved);
  for (const Json& method : json.at("leaders"))
    headline.leaders.push_back({.name = method.at("optimizer").get<std::string>(),
                                .solved = method.at("solved").get<std::size_t>(),
                                .runs = method.at("runs").get<std::size_t>(),
                                .median_work = real_of(method.at("median_work"))});
  return headline;
}

std::vector<Headline> headlines_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<Headline> all;
  for (const std::filesystem::path& file : files) try {
      Baseline baseline = baseline_from_json(read_json(file));
      baseline.headline.label = file.stem().string();
      all.push_back(std::move(baseline.headline));
    } catch (const UsageError&) {  // of a time before this schema
    }
  return all;
}

}  // namespace isoline::reports
