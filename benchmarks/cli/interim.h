// Until core has them.
#pragma once
#include <string>

#include "core/json.h"
namespace isoline {
std::string json_text(const Json& value, int indent = -1);
void set_program_tree(std::string commit, bool is_dirty);
}  // namespace isoline
