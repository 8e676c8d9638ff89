// Whether a text of a command line names a component of a record.
#pragma once

#include <string>
#include <string_view>

#include "core/records/request.h"

namespace isoline {

// By its name, by the specification that tables show, or by one whose options, in any order, have
// the values that the component has.
bool is_named(const Component& component, std::string_view text);

// The label in a plan of cells of a suite that were chosen on the command line: of a part of
// "contest@5", whose contrasts were named for the whole.
std::string part_of_suite(const std::string& label);

}  // namespace isoline
