// Options as JSON: what records hold of them, and what describes them.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/options.h"

namespace isoline {

using Json = nlohmann::json;

Json to_json(const OptionValues& options);  // an object; numbers survive
OptionValues option_values_from(
    const Json& json);  // UsageError where a value is of no type of ours
// Without the options of no text. They alone name a cell, so a component that gains an option which
// is empty by default keeps the names of its cells.
OptionValues without_empty(const OptionValues& options);
Json describe_options(const OptionTable& table);  // a list: name, type, default, law and meaning

}  // namespace isoline
