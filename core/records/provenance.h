// Where a number comes from: the program, its build and the machine.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace isoline {

using Json = nlohmann::json;

std::string version();  // "0.1.0"

// Version, commit, dirty or not, compiler, flags, instruction set, processor, cores, system,
// libraries. Read once.
const Json& provenance();

// Digest of all that may change a result besides the request: the revisions of the harness and of
// the two components, the versions of the libraries, the instruction set.
std::string build_digest(int problem_revision, int optimizer_revision);

}  // namespace isoline
