// What stands beside a foreign curve: what it is of, and which column holds which quantity. Schema
// isoline.import/1.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>

#include "core/oracle.h"
#include "core/real.h"
#include "core/status.h"

namespace isoline::benchmarks {

// By the name in the first line, or by its place, from 1.
using ColumnName = std::variant<std::string, std::int64_t>;

struct CurveDescription {
  std::string problem, optimizer;  // specs
  std::uint64_t seed = 0;
  std::string source, program;  // who says so; what computed it
  std::string date;             // "2026-01-31T12:00:00Z"
  std::string processor, claimed;
  Status status = Status::budget;               // how it ended, as they say
  std::optional<Real> minimum, scale, x_scale;  // f_L, s and ‖x*‖, where they tell them
  std::int64_t unknowns = 0, residuals = 0;     // 0: not told
  std::map<std::string, ColumnName> columns;    // by quantity
};

// Whether a call's declared price is the same on every problem.
bool has_plain_price(Oracle oracle);

// UsageError where it is none, or where laws between its members are broken.
CurveDescription description_from_text(const std::string& text, const std::string& origin);

}  // namespace isoline::benchmarks
