// The sections of a report, one file a topic; sections.cpp puts them in order.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/records/sheet.h"
#include "core/results/ranking.h"
#include "reports/sections/evidence.h"
#include "reports/sections/figures.h"
#include "reports/sections/section.h"

namespace isoline::reports {

using namespace results;

using Audits = std::vector<AuditedOptimizer>;

Section standings_section(const Comparison& comparison);
Section problems_section(const Comparison& comparison);  // a sentence each, and the matrix
Section learned_section(const Comparison& comparison);
Section amortized_section(const Comparison& comparison);  // training once, or solving each
Section claims_section(const std::vector<Judgement>& judgements);
// A line a claim, the refuted first.
Section claims_summary(const std::vector<Judgement>& judgements);
Section claim_section(const Judgement& judgement);  // one of them whole, with its evidence
// A table a paper: what it says, and the command, the time and the verdict of each claim.
Section papers_section(const std::vector<Judgement>& judgements);
Section properties_section(const Audits& audits);
Section tuning_section(
    const Comparison& comparison);  // where rates came from, and what they bought
Section statistics_section(const Comparison& comparison);
Section sweeps_section(const Comparison& comparison);   // two options at a time, as heat maps
Section spectra_section(const Comparison& comparison);  // of J, where runs kept them
Section failures_section(const Comparison& comparison);
Section builds_section(const Comparison& comparison);

// Sentences of them that others say too.
std::vector<std::string> verdict(const Comparison& comparison);    // what the decision says
std::string short_verdict(const Comparison& comparison);           // its first sentence
std::vector<Reading> ranking_facts(const Comparison& comparison);  // the group, how robust, not run
std::vector<std::string> learned_sentences(const Comparison& comparison);  // at equal work
std::string profile_reading(const Comparison& comparison, std::size_t tolerance);
std::string curve_reading(const Comparison& comparison, std::size_t problem);
std::string claims_reading(const std::vector<Judgement>& judgements);  // how many of each verdict
std::string verdict_text(const Judgement& judgement);                  // "partly on 3 seeds"
std::string marked_verdict(const Judgement& judgement);                // "≈ partly on 3 seeds"
std::vector<Reading> claim_notes(const Judgement& judgement);          // beside its figures
std::string measured_text(const Judgement& judgement);                 // "23.4 (18.2–31), n = 3"
// The distinguishing name of a term: its optimizer, its problem if they differ, its abscissa.
std::vector<std::string> term_names(const Evidence& evidence);
// One plot, or none where the figures have no curve and no abscissa.
std::vector<Plot> claim_plots(const Evidence& evidence, const std::string& id);
// A summary of this data, one sentence per property; the last on false declarations.
std::vector<Reading> property_readings(const Audits& all);
std::vector<Plot> property_plots(const Audits& all);  // of each property that is a number
std::string headline(const Comparison& comparison);
std::string missing_text(const Comparison& comparison);
std::vector<std::string> remarks(const Comparison& comparison);

// A report before it has a format: its sections in order, and what they were made from.

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
