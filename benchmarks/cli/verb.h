// A verb of the command line: each file of benchmarks/verbs defines register_NAME(VerbRegistry&),
// and CMake lists them; verbs that are read together share a file. Its arguments are declared
// without the library that parses them.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/options.h"
#include "core/registry.h"
#include "core/status.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace isoline::benchmarks {

struct Catalog;
struct Claim;

// The state that verbs share: the catalog, which includes the libraries of --plugin, and the claims
// with their cells, each made at its first use, and the command for the records.
class Session {
 public:
  Session(std::string command, std::function<Catalog()> make);
  std::vector<std::string>& plugins() { return plugins_; }  // paths
  const Catalog& catalog();
  const std::vector<Claim>& claims();
  const std::string& command() const { return command_; }

 private:
  std::string command_;
  std::function<Catalog()> make_;
  std::vector<std::string> plugins_;
  std::shared_ptr<const Catalog> catalog_;
  std::shared_ptr<const std::vector<Claim>> claims_;
};

using ListedValues = std::map<const CLI::Option*, std::vector<std::string>>;

// One argument. Each function adds a property and returns the argument.
class Argument {
 public:
  Argument(CLI::Option& option, ListedValues& choices) : option_(&option), choices_(&choices) {}
  Argument required() const;
  Argument shown() const;  // its default, in the help
  Argument shown(const std::string& standard) const;
  Argument one_of(const std::vector<std::string>& names) const;
  Argument between_commas() const;
  Argument one_each() const;  // the option may occur more than once, with one value each
  Argument may_be_empty() const;
  Argument joined() const;  // joined by commas, if it occurs more than once
  Argument needs(const Argument& other) const;
  Argument excludes(const Argument& other) const;

 private:
  CLI::Option* option_;
  ListedValues* choices_;
};

struct WholeRange {
  std::int64_t low = 1, high = kMostAmount;
};
inline constexpr WholeRange kJobs{1, 1024}, kThreads{1, 256}, kShards{1, 100'000};

// The arguments of one verb. A name without dashes is a positional argument.
class VerbArguments {
 public:
  VerbArguments(CLI::App& verb, Session& session) : verb_(verb), session_(session) {}
  Argument text(const char* name, std::string& value, const char* about);
  Argument texts(const char* name, std::vector<std::string>& values, const char* about);
  Argument flag(const char* name, bool& value, const char* about);
  // The help shows a default that lies within the range.
  Argument whole(const char* name, int& value, const char* about, WholeRange range = {});
  Argument whole(const char* name, std::int64_t& value, const char* about, WholeRange range = {});
  // "never" is 0.
  void whole_or_never(const char* name, std::int64_t& value, const char* about);
  Argument real(const char* name, double& value, const Range& range, const char* about);
  void seed(const char* name, std::uint64_t& value, const char* about);
  void time(const char* name, double& seconds, const char* about);
  void memory(const char* name, std::int64_t& bytes, const char* about, int least_megabytes = 16);
  void plugins();                                           // --plugin, of the session
  const ListedValues& choices() const { return choices_; }  // of the arguments with one_of()

 private:
  Argument argument(CLI::Option& option) { return {option, choices_}; }

  CLI::App& verb_;
  Session& session_;
  ListedValues choices_;
};

struct Verb {
  std::string name;
  int help_position = 0;   // the help lists verbs in ascending order, in groups (command_line.cpp)
  bool is_hidden = false;  // in the help
  std::string summary;
  std::string examples;  // lines that begin with "  isoline "
  std::string notes = {};
  std::function<void(VerbArguments&)> declare = {};
  std::function<int(Session&)> run = {};  // its exit code
};
using VerbRegistry = Registry<Verb>;

// A verb whose arguments are a struct with defaults.
template <class Arguments>
Verb verb_of(Verb verb, void (*declare)(VerbArguments&, Arguments&),
             int (*run)(const Arguments&, Session&)) {
  const auto given = std::make_shared<Arguments>();
  verb.declare = [declare, given](VerbArguments& arguments) { declare(arguments, *given); };
  verb.run = [run, given](Session& session) { return run(*given, session); };
  return verb;
}

void register_verbs(VerbRegistry& registry);  // generated: one call per file

// All verbs, in the order of the help; `help` and `version` are the last.
std::vector<Verb> all_verbs();

// The words of a command line. An earlier name of a command, and its options, become the present
// ones, with a line about it on standard error. One release keeps these names.
std::vector<std::string> present_words(std::vector<std::string> words, const std::string& program);

// An argument as its declaration describes it, for completions and the manual.
struct ArgumentText {
  std::string name;   // "--seeds", or "SUITE" of a positional argument
  std::string value;  // the type of its value, empty if it has none
  std::string about;
  std::vector<std::string> choices;  // all values that it can have; empty: not listed
};
std::vector<ArgumentText> arguments_of(const Verb& verb);

// The first sentences of the help.
std::string program_summary();

// Runs the verb of the arguments and returns its exit code; UsageError if the arguments are wrong.
// `program` is the name that the user called.
int parse_and_run(const std::string& program, int count, char** arguments, Session& session);

// Parses the arguments without running the verb.
void parse_only(const std::string& program, int count, char** arguments);

std::string program_examples();

inline constexpr const char* kFolders = "Result folders of `isoline run`";

}  // namespace isoline::benchmarks
