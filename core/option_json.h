// Options as JSON: what records hold of them, and what describes them.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/options.h"

namespace isoline {

using Json = nlohmann::json;

Json to_json(const OptionValues& options);  // an object; numbers survive
OptionValues option_values_from(
    const Json& json);                            // UsageError where a value is of no type of ours
Json describe_options(const OptionTable& table);  // a list: name, type, default, law and meaning

}  // namespace isoline
