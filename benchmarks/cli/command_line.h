// How verbs and their arguments are written on a command line.
#pragma once

#include <string>
#include <vector>

namespace isoline::benchmarks {

class Session;
struct RunArguments;

// Runs the verb that the arguments name and returns its exit code; says what is wrong with them
// where they name none. `program` is what the user called.
int parse_and_run(const std::string& program, int count, char** arguments, Session& session);

// The same without running it: UsageError where the arguments are wrong.
void parse_only(const std::string& program, int count, char** arguments);

// What would stand after `isoline run`, read as it reads it.
RunArguments read_run_arguments(const std::string& program, const std::vector<std::string>& words);

}  // namespace isoline::benchmarks
