// The members of a record as text, which comparisons digest: a tenth of the time of a tree.
#pragma once

#include <map>
#include <set>
#include <string>

#include "core/records/record.h"

namespace isoline {

// The paths of what result_of() leaves out of a record, such as "summary/wall_seconds".
const std::set<std::string>& paths_beside_results();

// Each member without the paths that are left out, as json_text() prints it: "name":value.
std::map<std::string, std::string> member_texts(const Record& record,
                                                const std::set<std::string>& left_out);

}  // namespace isoline
