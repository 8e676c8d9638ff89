// Reads conflicts of an earlier merge, and tells those of this one.
#include "benchmarks/merge/conflicts.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/errors.h"
#include "core/files.h"
#include "core/records/json_view.h"

namespace isoline::benchmarks {
namespace {

std::set<std::string> names_at(const JsonView& json, const char* key) {
  const auto names = json.at(key).get<std::vector<std::string>>();
  return {names.begin(), names.end()};
}

std::string heading(const std::string& optimizer, std::size_t count) {
  const char* const plural = count == 1 ? "" : "s";
  if (optimizer.empty()) return fmt::format("{} more conflict{}", count, plural);
  return fmt::format("{}: {} conflict{}", optimizer, count, plural);
}

}  // namespace

Disputed disputed_in(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "conflicts.json";
  Disputed disputed;
  if (!is_there(file)) return disputed;
  try {
    JsonReader reader;
    const JsonView json = reader.parse(read_text(file, kMostBytes, Links::refused), file.string());
    disputed.records = names_at(json, "records");
    if (json.contains("audits")) disputed.audits = names_at(json, "audits");
    return disputed;
  } catch (const UsageError& error) {
    throw UsageError(fmt::format(
        "{} should name the conflicts of an earlier merge, without which this one would choose by "
        "accident: {}",
        file.string(), error.what()));
  }
}

std::string told(const std::vector<Conflict>& conflicts) {
  constexpr std::size_t kExamples = 3;
  std::map<std::string, std::vector<std::string>> groups;
  for (const Conflict& conflict : conflicts)
    groups[conflict.optimizer].push_back(conflict.sentence);
  std::vector<std::string> optimizers;
  for (const auto& [optimizer, sentences] : groups) optimizers.push_back(optimizer);
  std::ranges::stable_sort(optimizers, [&](const std::string& a, const std::string& b) {
    return std::pair(a.empty(), groups[b].size()) < std::pair(b.empty(), groups[a].size());
  });
  std::string text;
  for (const std::string& optimizer : optimizers) {
    std::vector<std::string>& sentences = groups[optimizer];
    std::ranges::sort(sentences);
    text += heading(optimizer, sentences.size()) + "\n";
    for (std::size_t i = 0; i < std::min(kExamples, sentences.size()); ++i)
      text += "  " + sentences[i] + "\n";
    if (sentences.size() > kExamples)
      text += fmt::format("  … and {} more\n", sentences.size() - kExamples);
  }
  return text;
}

}  // namespace isoline::benchmarks
