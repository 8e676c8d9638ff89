// Claims of papers judged by records. A claim is JSON, form isoline.claims/1, in which each set of
// cells also has what makes it findable among records: "iterations" and, for each term of the
// quantity and of its contrast, its alternatives as {"title", "cells"}: a digest a seed.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reports/sections/quantities.h"

namespace isoline::reports {

enum class Verdict { reproduced, partly, not_reproduced, not_comparable };
inline constexpr std::array<std::string_view, 4> kVerdictNames = {
    "reproduced", "partly", "not reproduced", "not comparable"};
inline std::string_view name_of(Verdict verdict) {
  return kVerdictNames[static_cast<std::size_t>(verdict)];
}

// What a claim is held against, so that it can be refuted: a bound that every method keeps says
// nothing of the one that is named.
struct Contrast {
  std::string quantity, published;
  std::optional<Measurement> measured;
};

struct Judgement {
  std::string id, sentence, source, quantity, published, caveat;
  Verdict verdict = Verdict::not_comparable;
  std::string why;  // it is not comparable
  std::optional<Measurement> measured;
  std::optional<Contrast> contrast;
  std::vector<std::string> cells;  // that decide it, of those there are
  bool is_covered = false;         // all cells of one of its lengths are among the records
};

// In the order of the claims. The first set of cells that is complete counts: the longest.
std::vector<Judgement> judge(const nlohmann::json& claims, const std::vector<Record>& runs);

// Within the source's own error of what it says: reproduced; else on the same side of the
// quantity's neutral value: partly. Of a claim, or of its contrast.
Verdict verdict_of(Real measured, const nlohmann::json& claim);

}  // namespace isoline::reports
