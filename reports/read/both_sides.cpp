// Joins two studies under names that keep them apart.
#include "reports/read/both_sides.h"

#include <algorithm>

namespace isoline::reports {
namespace {

std::string mark_of(const std::string& side) { return ", " + side; }

void mark(Study& study, const std::string& side) {
  for (Record& record : study.runs) {
    Component& optimizer = record.request.optimizer;
    for (std::string* text : {&optimizer.name, &optimizer.spec}) *text += mark_of(side);
  }
  for (Sheet& sheet : study.sheets)
    if (sheet.kind == "optimizer")
      for (std::string* text : {&sheet.name, &sheet.spec}) *text += mark_of(side);
}

template <class One>
void append(std::vector<One>& all, std::vector<One>& more) {
  std::ranges::move(more, std::back_inserter(all));
}

// "adam, BASE, tuned" without its side.
std::string without(std::string label, const std::string& side) {
  if (const std::size_t at = label.find(mark_of(side)); at != std::string::npos)
    label.erase(at, mark_of(side).size());
  return label;
}

bool has(const std::string& label, const std::string& side) {
  return label.find(mark_of(side)) != std::string::npos;
}

}  // namespace

Study study_of_both(Study before, Study after) {
  mark(before, kSides[0]);
  mark(after, kSides[1]);
  Study both = std::move(after);
  append(both.runs, before.runs);
  append(both.sheets, before.sheets);  // behind: the first of a name is taken
  append(both.unreadable, before.unreadable);
  append(both.folders, before.folders);
  both.superseded += before.superseded;
  for (std::string& suite : before.plan.suites)
    if (std::ranges::find(both.plan.suites, suite) == both.plan.suites.end())
      both.plan.suites.push_back(std::move(suite));
  both.plan.cells.clear();
  both.audits.clear();
  return both;
}

Comparison compare_sides(const Study& both) {
  Comparison c = compare_optimizers(both);
  for (OptimizerAxis& axis : c.optimizers)
    for (const char* side : kSides)
      if (has(axis.label, side)) {
        axis.side = side;
        axis.method = without(axis.method, side);
      }
  return c;
}

std::vector<InBoth> methods_in_both(const Comparison& c) {
  std::vector<InBoth> all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    if (c.optimizers[s].side != kSides[0]) continue;
    const std::string label = without(c.optimizers[s].label, kSides[0]);
    for (std::size_t t = 0; t < c.optimizers.size(); ++t)
      if (c.optimizers[t].side == kSides[1] && without(c.optimizers[t].label, kSides[1]) == label)
        all.push_back({label, s, t});
  }
  std::ranges::sort(all, {}, &InBoth::label);
  return all;
}

}  // namespace isoline::reports
