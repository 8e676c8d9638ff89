// Whether a record agrees with itself: its success criterion, and the figures that follow from
// other figures of the same record. A change by hand, or a fault of the program, breaks them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/records/record.h"

namespace isoline {

// The criterion by which a run succeeded, and the costs in which its work is counted.
struct Criterion {
  std::optional<Real> minimum, scale, x_scale;  // f_L, s and ‖x*‖, where they are known
  Real x_floor = 0;
  Aim aim = Aim::loss;
  OracleCounts prices{};  // nominal costs

  bool operator==(const Criterion&) const = default;
};
Criterion criterion_of(const Record& record);
std::string digest_of(const Criterion& criterion);  // what `Record::criterion` holds

// A sentence for each invariant that the record breaks; none of a sound one. Of a run that broke
// off, or that others made, fewer hold.
std::vector<std::string> broken_invariants(const Record& record);

}  // namespace isoline
