// Earlier names of commands, which run the present ones for one release.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "benchmarks/cli/verb.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

using Words = std::vector<std::string>;

// Takes an option with its value out of the words.
std::optional<std::string> taken(Words& words, const std::string& option) {
  const auto at = std::ranges::find_if(words, [&](const std::string& word) {
    return word == option || word.starts_with(option + "=");
  });
  if (at == words.end()) return std::nullopt;
  const bool is_next = *at == option && at + 1 != words.end();
  std::string value = is_next ? at[1] : at->substr(std::min(at->size(), option.size() + 1));
  words.erase(at, at + (is_next ? 2 : 1));
  return value;
}

Words joined(Words first, const Words& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

Words of_best(Words words) {
  const std::string table = taken(words, "--out").value_or("benchmarks/best.json");
  return joined({"baseline", "--best", table}, words);
}

Words of_status(Words words) {
  for (std::string& word : words)  // a folder may have the name of a suite
    if (!word.starts_with('-') && word.find('/') == word.npos) word.insert(0, "./");
  return joined({"run", "--dry-run"}, words);
}

// The optimizers and those that they are compared with are one list.
Words of_score(Words words) {
  std::string all = taken(words, "--peers")
                        .value_or(
                            "levenberg-marquardt,ceres-lm,ceres-tiny,minpack-lmder,"
                            "gsl-multifit[trust-region=lm|lmaccel]");
  if (all == "none") all.clear();
  while (const auto one = taken(words, "--optimizer")) all = all.empty() ? *one : *one + "," + all;
  const bool has_suite = !words.empty() && !words.front().starts_with('-');
  Words now = {"run", has_suite ? words.front() : "nist", "--view", "digits", "--no-report"};
  if (!all.empty()) now = joined(now, {"--instead", all});
  return joined(now, {words.begin() + (has_suite ? 1 : 0), words.end()});
}

struct OldName {
  const char* present;  // as the message names it
  Words (*words)(Words);
};

const std::map<std::string, OldName> kOldNames = {
    {"plan",
     {"run --dry-run",
      [](Words words) {
        return joined({"run", "--dry-run"}, words);
      }}},
    {"status", {"run DIR --dry-run", of_status}},
    {"list", {"describe", [](Words words) { return joined({"describe"}, words); }}},
    {"score", {"run nist --instead SPEC --view digits", of_score}},
    {"choose",
     {"report --view choice",
      [](Words words) {
        return joined({"report", "--view", "choice"}, words);
      }}},
    {"infer", {"solution", [](Words words) { return joined({"solution"}, words); }}},
    {"best", {"baseline --best", of_best}}};

}  // namespace

std::vector<std::string> present_words(Words words, const std::string& program) {
  const std::size_t at = words.size() > 1 && words.front() == "help" ? 1 : 0;
  if (words.size() <= at || !kOldNames.contains(words[at])) return words;
  const OldName& old = kOldNames.at(words[at]);
  say(stderr, fmt::format("{0}: the command {1} is now `{0} {2}`; the next release no longer has "
                          "the old name\n",
                          program, words[at], old.present));
  const Words arguments(words.begin() + static_cast<std::ptrdiff_t>(at) + 1, words.end());
  if (at == 1) return {"help", old.words({}).front()};
  return old.words(arguments);
}

}  // namespace isoline::benchmarks
