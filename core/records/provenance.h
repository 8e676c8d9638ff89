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

// Records name this commit instead of Isoline's own, which they then name beside it. Called once,
// before the first record.
void set_program_tree(std::string commit, bool is_dirty);

// Digest of all that may change a result besides the request: the revisions of the harness and of
// the two components, the versions of the libraries, the instruction set.
std::string build_digest(int problem_revision, int optimizer_revision);

}  // namespace isoline
