// UM-Bridge as its client has it: what is asked of a server, and its answers read. Whatever a
// server says is held to bounds; what is none of the protocol is a UsageError, which says what came
// instead.
#pragma once

#include <string>
#include <vector>

#include "core/bridge_messages.h"

namespace isoline {

std::string name_text(const std::string& model, const std::string& config);  // config is JSON
std::string call_text(const std::string& model, const std::string& config, const BridgeCall& call);
std::vector<std::string> models_in(const std::string& info);
std::vector<Index> input_sizes_in(const std::string& answer);
std::vector<Index> output_sizes_in(const std::string& answer);
BridgeSupport support_in(const std::string& answer);
std::vector<Numbers> outputs_in(const std::string& answer);
Numbers output_in(const std::string& answer);
// "InvalidInput: …" of an answer that is an error; empty where it is none.
std::string error_in(const std::string& answer);

// A list of numbers, "[1, 2.5, NaN]"; a config, an object, as it is to be sent.
Numbers numbers_in(const std::string& json, const std::string& origin);
std::string config_in(const std::string& json, const std::string& origin);

}  // namespace isoline
