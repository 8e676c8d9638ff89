// The command line: which verb it names, and its arguments, numbers among them.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/cli/verb.h"

namespace isoline::benchmarks {

// Runs the verb that the arguments name and returns its exit code; UsageError where they are wrong.
// `program` is what the user called.
int parse_and_run(const std::string& program, int count, char** arguments, Session& session);

// The same without running it.
void parse_only(const std::string& program, int count, char** arguments);

// The arguments of one verb, read from what would stand after its name.
void read_arguments(const std::string& program, const Verb& verb,
                    const std::vector<std::string>& words, Session& session);

// "Examples:", those of the verb, and its notes.
std::string verb_notes(const Verb& verb);
std::string program_examples();

// Parses complete numbers: it drops no sign and does not clamp. UsageError, which begins with
// `option`, if the text is not a number or is out of range.
std::int64_t read_whole(const std::string& option, const std::string& text, WholeRange range);
std::uint64_t read_seed(const std::string& option, const std::string& text);
double read_real(const std::string& option, const std::string& text, const Range& range);
double read_time(const std::string& option, const std::string& text);  // seconds, of "2m"

// "2GB", "1.5GiB" or bytes; a unit is 1024 of the one before. Less than 16MB starts no cell.
std::int64_t read_bytes(const std::string& option, const std::string& text);

}  // namespace isoline::benchmarks
