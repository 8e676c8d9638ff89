// Fields in the page.
#pragma once

#include <string>

#include "reports/read/found_fields.h"

namespace isoline::reports {

std::string fields_html(const Comparison& comparison, const FoundFields& all);
std::string fields_json(const FoundFields& all);

}  // namespace isoline::reports
