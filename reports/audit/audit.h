// The audit of properties in a report: one table, in every format, a sentence that reads each
// property, and a plot of each on the page.
#pragma once

#include <string>
#include <vector>

#include "core/records/audited.h"

namespace isoline::reports {

struct Comparison;

struct AuditColumn {
  const char* heading;
  const char* meaning;  // for a reader who meets it first
  std::string (*cell)(const AuditedOptimizer&);
};
extern const std::vector<AuditColumn> kAuditColumns;

// What this data says, a sentence a property; the last on false declarations.
struct AuditReading {
  std::string property, sentence;
};
std::vector<AuditReading> audit_readings(const std::vector<AuditedOptimizer>& all);

// Empty where nothing was audited.
std::string audit_html(const std::vector<AuditedOptimizer>& all);
std::string audit_markdown(const std::vector<AuditedOptimizer>& all);
std::string audit_latex(const std::vector<AuditedOptimizer>& all);
Json audit_json(const std::vector<AuditedOptimizer>& all);  // the file's, and what reads it
std::string audit_terminal(const std::vector<AuditedOptimizer>& all);

// A dot a series in a row an optimizer, as SVG that needs no script.
struct DotSeries {
  std::string name;
  std::vector<Real> values;  // one a row; not-a-number is not drawn
};
std::string dot_plot(const std::string& title, const std::vector<std::string>& rows,
                     const std::vector<DotSeries>& series, const std::vector<Real>& ticks);

}  // namespace isoline::reports
