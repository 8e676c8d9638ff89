// θ = x of a direct problem, which is what its user wants: as the run returned it, and the point of
// least loss where that is another one.
#pragma once

#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/real.h"
#include "core/records/part.h"

namespace isoline {

// Beyond kInline unknowns, the numbers stand beside the record in CELL-BUILD.x.npy: float64 of the
// shape (points, unknowns).
struct AnswerPoints {
  static constexpr Part kPart{
      .member = "answer",
      .law = R"({"description": "θ = x of a direct problem, as returned and of least loss"})"};
  static constexpr std::size_t kInline = 1000;
  Index unknowns = 0;
  std::vector<std::string> names = {};    // (unknowns); empty: x1, x2, …
  std::vector<std::string> units = {};    // (unknowns), each may be empty; empty: none has one
  std::vector<std::string> points = {};   // kReturned, kBest or both
  std::vector<std::vector<Real>> x = {};  // (points, unknowns); empty where the file has them
  // Unknowns, from 0, that lie on such a bound at the point of least loss.
  std::vector<Index> at_lower = {}, at_upper = {};
  std::vector<Real> scales = {};           // (unknowns), by which methods saw x divided; empty: 1
  std::optional<Real> residual_norm = {};  // ‖y − y*‖ at the returned point
  std::string digest = {};                 // of the file, if there is one

  // The numbers of that point; nothing where it is not kept, or where they are not read.
  std::span<const Real> point(const char* name) const {
    for (std::size_t i = 0; i < x.size(); ++i)
      if (points[i] == name) return x[i];
    return {};
  }
  bool is_in_file() const { return !digest.empty(); }
  std::string name(std::size_t i) const {
    return i < names.size() ? names[i] : "x" + std::to_string(i + 1);
  }
  std::string unit(std::size_t i) const { return i < units.size() ? units[i] : ""; }
  bool is_bound_active() const { return !at_lower.empty() || !at_upper.empty(); }
  const char* bound(std::size_t i) const {  // "lower" or "upper", if x lies on one
    const auto has = [&](const std::vector<Index>& all) {
      return std::find(all.begin(), all.end(), static_cast<Index>(i)) != all.end();
    };
    return has(at_lower) ? "lower" : has(at_upper) ? "upper" : "";
  }
};
inline constexpr const char *kReturned = "returned", *kBest = "best";

void fields(Like<AnswerPoints> auto& answer, auto& field) {
  field("unknowns", answer.unknowns, kCountLaw);
  field.optional("names", answer.names,
                 R"({"description": "Of the unknowns; x1, x2, … if absent"})");
  field.optional("units", answer.units,
                 R"({"description": "Of the unknowns; an empty text if one has no unit"})");
  field("points", answer.points, R"({"items": {"enum": ["returned", "best"]}})");
  field.optional("at_lower", answer.at_lower,
                 R"({"description": "Unknowns on their lower bound, from 0, where L is least"})");
  field.optional("at_upper", answer.at_upper,
                 R"({"description": "Unknowns on their upper bound, from 0, where L is least"})");
  field.optional("scales", answer.scales,
                 R"({"description": "Of the unknowns: methods saw x divided by them"})");
  field.optional("digest", answer.digest,
                 R"({"pattern": "^[0-9a-f]{16}$", "description": "Of the file with the numbers"})");
  if (!std::remove_cvref_t<decltype(field)>::kWrites || !answer.is_in_file())
    field.optional("x", answer.x, R"({"description": "A list for each of the points"})");
  field.optional("residual_norm", answer.residual_norm,
                 R"({"description": "‖y − y*‖ at the returned point"})");
}

void require_sound(const AnswerPoints& answer);       // UsageError where sizes or names disagree
std::string answer_file(const AnswerPoints& answer);  // the file's bytes
inline std::filesystem::path answer_path(std::filesystem::path record) {
  return record.replace_extension(".x.npy");
}
// The numbers out of the file, if there is one; UsageError, naming it, where it is missing, is
// damaged or is another run's.
void read_answer_numbers(AnswerPoints& answer, const std::filesystem::path& path);

}  // namespace isoline
