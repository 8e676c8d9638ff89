// A report before it has a format: its sections in order, and what they were made from.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "reports/read/comparison.h"
#include "reports/sections/figures.h"
#include "reports/sections/section.h"
#include "reports/sections/verdicts.h"

namespace isoline::reports {

struct Document {
  Comparison comparison;  // of a study that must outlive it
  std::vector<Judgement> claims;
  std::string out = {};    // the folder that it goes to, where that is known: links start there
  std::string headline;    // "33 optimizers on 16 problems, …"
  std::string statuses;    // "target 3, budget 2"
  std::string incomplete;  // which cells are missing; empty where none is
  std::vector<std::string> remarks;  // what a reader must know before believing the tables
  std::vector<Section> sections;
  std::vector<Figure> figures;

  const Section& section(std::string_view id) const;
};

// Claims are those whose cells are among the runs.
Document document_of(Comparison comparison, std::vector<Judgement> claims = {});

}  // namespace isoline::reports
