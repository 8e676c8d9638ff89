// Whether a text of a command line names a component of a record.
#pragma once

#include <string_view>

#include "core/records/request.h"

namespace isoline {

// By its name, by the specification that tables show, or by one whose options, in any order, have
// the values that the component has.
bool is_named(const Component& component, std::string_view text);

}  // namespace isoline
