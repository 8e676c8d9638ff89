// Claims of papers judged by records. A claim is JSON, form isoline.claims/1, in which each set of
// cells also has what makes it findable among records: "iterations" and, for each term of the
// quantity and of its contrast, its alternatives as {"title", "cells"}: a digest a seed.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "reports/sections/claim_evidence.h"

namespace isoline::reports {

// What a claim is held against, so that it can be refuted: a bound that every method keeps says
// nothing of the one that is named.
struct Contrast {
  std::string quantity, published;
  std::optional<Measurement> measured;
  Evidence evidence;
};

struct Judgement {
  std::string id, sentence, source, quantity, published, caveat;
  std::string fact;  // the claim whose fact this one restates, or itself
  Verdict verdict = Verdict::not_comparable;
  std::string why;  // it is too short, or not comparable
  std::optional<Measurement> measured;
  std::optional<Agreement> band;
  Evidence evidence;          // none where nothing decides it
  std::vector<CellSet> sets;  // the longest first
  std::optional<Contrast> contrast;
  std::vector<std::string> cells;     // that decide it, of those there are
  std::vector<std::string> survives;  // nulls under which it would come out no worse, in words
  std::int64_t needs = 0;             // iterations
  bool is_drawn = false;              // its runs are of seeds, of which others could be drawn
  bool is_covered = false;            // all cells of one of its lengths are among the records
};

// In the order of the claims. The first set of cells that is complete counts: the longest.
std::vector<Judgement> judge(const nlohmann::json& claims, const std::vector<Record>& runs);

// The verdict on each fact: the weakest of the claims that restate it, of those that are decided.
std::vector<Verdict> verdicts_on_facts(const std::vector<Judgement>& judgements);

}  // namespace isoline::reports
