// The one place where CLI11 parses: the program, its verbs and what is wrong with a command.
#include "benchmarks/cli/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <deque>

#include "benchmarks/cli/notes.h"
#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verb_arguments.h"
#include "benchmarks/cli/verb_table.h"
#include "core/errors.h"
#include "core/records/provenance.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

std::string refuse_empty(std::string& text) { return text.empty() ? "it must not be empty" : ""; }

// A function a type keeps CLI11's templates out of the verbs, where they would be laid out anew at
// each call.
template <class Value>
[[gnu::noinline]] CLI::Option* option(CLI::App& verb, const char* name, Value& value,
                                      const char* about) {
  return verb.add_option(name, value, about)->check(CLI::Validator(refuse_empty, ""));
}

// A number that `read` reads by its law, of the option's name and the text.
template <class Value, class Read>
CLI::Option* number(CLI::App& verb, const char* name, const char* type, Value& value,
                    const char* about, const Read& read) {
  const std::function<void(const std::string&)> set = [=, &value](const std::string& text) {
    value = static_cast<Value>(read(name, text));
  };
  return verb.add_option_function(name, set, about)->type_name(type);
}

template <class Value>
void whole_number(CLI::App& verb, const char* name, Value& value, const char* about, WholeLaw law) {
  CLI::Option* made = number(verb, name, "INT", value, about,
                             [law](auto& of, auto& text) { return read_whole(of, text, law); });
  if (value >= law.low) made->default_str(std::to_string(value));
}

class ParsedArgument final : public Argument {
 public:
  explicit ParsedArgument(CLI::Option& option) : option_(option) {}

  const Argument& required() const override {
    option_.required();
    return *this;
  }
  const Argument& shown() const override {
    option_.capture_default_str();
    return *this;
  }
  const Argument& shown(const std::string& standard) const override {
    option_.default_str(standard);
    return *this;
  }
  const Argument& one_of(const std::vector<std::string>& names) const override {
    const auto refuse = [names](const std::string& given) {
      const bool is_known = std::ranges::find(names, given) != names.end();
      return is_known ? "" : unknown_name("value", given, names);
    };
    option_.check(refuse);
    return *this;
  }
  const Argument& between_commas() const override {
    option_.delimiter(',')->allow_extra_args(false);
    return *this;
  }
  const Argument& one_each() const override {
    option_.allow_extra_args(false);
    return *this;
  }
  const Argument& joined() const override {
    option_.join(',');
    return *this;
  }
  const Argument& needs(const Argument& other) const override {
    option_.needs(option_of(other));
    return *this;
  }
  const Argument& excludes(const Argument& other) const override {
    option_.excludes(option_of(other));
    return *this;
  }

 private:
  static CLI::Option* option_of(const Argument& argument) {
    return &static_cast<const ParsedArgument&>(argument).option_;
  }
  CLI::Option& option_;
};

class ParsedVerb final : public VerbArguments {
 public:
  explicit ParsedVerb(CLI::App& verb) : verb_(verb) {}

  const Argument& text(const char* name, std::string& value, const char* about) override {
    return kept(option(verb_, name, value, about));
  }
  const Argument& texts(const char* name, std::vector<std::string>& values,
                        const char* about) override {
    return kept(option(verb_, name, values, about));
  }
  const Argument& flag(const char* name, bool& value, const char* about) override {
    return kept(verb_.add_flag(name, value, about));
  }
  void whole(const char* name, int& value, const char* about, WholeLaw law) override {
    whole_number(verb_, name, value, about, law);
  }
  void whole(const char* name, std::int64_t& value, const char* about, WholeLaw law) override {
    whole_number(verb_, name, value, about, law);
  }
  const Argument& real(const char* name, double& value, const Range& range,
                       const char* about) override {
    return kept(number(verb_, name, "FLOAT", value, about,
                       [range](auto& of, auto& text) { return read_real(of, text, range); }));
  }
  void seed(const char* name, std::uint64_t& value, const char* about) override {
    number(verb_, name, "UINT", value, about, read_seed)->default_str(std::to_string(value));
  }
  void time(const char* name, double& seconds, const char* about) override {
    number(verb_, name, "TIME", seconds, about, read_time);
  }
  void memory(const char* name, std::int64_t& bytes, const char* about) override {
    number(verb_, name, "SIZE", bytes, about, read_bytes);
  }

 private:
  const Argument& kept(CLI::Option* option) { return arguments_.emplace_back(*option); }

  CLI::App& verb_;
  std::deque<ParsedArgument> arguments_;  // they stay where they are
};

std::vector<std::string> names_of(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

// Of an option with no value, or with two where one is taken.
std::string sentence_on_values(const CLI::App& verb, const std::string& name) {
  const CLI::Option* option = verb.get_option_no_throw(name);
  const bool is_repeated = option != nullptr && option->count() > 1;
  return name + (is_repeated ? " is given more than once" : " needs a value");
}

// Of what CLI11 could place nowhere the first.
std::string sentence_on(const CLI::App& verb, const std::string& unexpected) {
  if (!unexpected.starts_with('-'))
    return fmt::format("{} takes no further argument, got '{}'", verb.get_name(), unexpected);
  const std::string name = unexpected.substr(0, unexpected.find('='));
  const std::string nearest = nearest_name(name, names_of(verb));
  return fmt::format("unknown option {}{}", name,
                     nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest));
}

template <class Kind>
bool is_a(const CLI::ParseError& error) {
  return dynamic_cast<const Kind*>(&error) != nullptr;
}

class CommandLine {
 public:
  // `runs`: or only reads.
  CommandLine(const std::string& program, Session& session, bool runs);
  int read(int count, char** arguments);  // and runs; the exit code
  const RunArguments& run() const { return *table_.run; }

 private:
  void add(const Verb& verb);
  void add_help();
  void add_version();
  void require_verb(const std::string& name) const;
  std::vector<std::string> verbs() const;
  std::string help_text() const;
  std::string sentence_of(const CLI::ParseError& error) const;

  const std::string program_;
  Session& session_;
  const bool runs_;
  const VerbTable table_ = verb_table();
  CLI::App app_;
  std::string helped_;  // the verb that help is wanted of; empty: of the program
  int exit_code_ = kGood;
};

CommandLine::CommandLine(const std::string& program, Session& session, bool runs)
    : program_(program), session_(session), runs_(runs), app_(kAbout, program) {
  app_.footer(kExamples);
  app_.set_version_flag("--version", "isoline " + version());
  app_.require_subcommand(1);
  app_.get_formatter()->label("SUBCOMMAND", "VERB");
  for (const Verb& verb : table_.verbs) add(verb);
  add_help();
  add_version();
  table_.completion->verbs = verbs();
  for (CLI::App* verb : app_.get_subcommands({})) verb->group("Verbs");
}

void CommandLine::add(const Verb& verb) {
  CLI::App& declared = *app_.add_subcommand(verb.name, verb.about);
  ParsedVerb parsed(declared);
  verb.declare(parsed);
  declared.footer(notes_of(verb.name));
  declared.callback([this, &verb] {
    if (runs_) exit_code_ = verb.run(session_);
  });
}

void CommandLine::add_help() {
  CLI::App& help = *app_.add_subcommand("help", "Print the help of the program or of a verb");
  option(help, "VERB", helped_, "The verb (default: the program)");
  help.footer(notes_of("help"));
  help.callback([this] {
    if (!helped_.empty()) require_verb(helped_);
    if (runs_) say(stdout, help_text());
  });
}

void CommandLine::add_version() {
  CLI::App& version_of = *app_.add_subcommand("version", "Print the version");
  version_of.footer(notes_of("version"));
  version_of.callback([this] {
    if (runs_) say(stdout, fmt::format("isoline {}\n", version()));
  });
}

std::vector<std::string> CommandLine::verbs() const {
  std::vector<std::string> names;
  for (const CLI::App* verb : app_.get_subcommands({})) names.push_back(verb->get_name());
  return names;
}

// By the formatter: App::help() would tell of the verb `help` itself.
std::string CommandLine::help_text() const {
  const CLI::App& of = helped_.empty() ? app_ : *app_.get_subcommand(helped_);
  const std::string name = helped_.empty() ? program_ : program_ + " " + helped_;
  return app_.get_formatter()->make_help(&of, name, CLI::AppFormatMode::Normal);
}

void CommandLine::require_verb(const std::string& name) const {
  const std::vector<std::string> known = verbs();
  require(std::ranges::find(known, name) != known.end(),
          [&] { return unknown_name("verb", name, known); });
}

std::string CommandLine::sentence_of(const CLI::ParseError& error) const {
  const std::vector<const CLI::App*> parsed =
      app_.get_subcommands([](const CLI::App* verb) { return verb->parsed(); });
  const CLI::App& verb = parsed.empty() ? app_ : *parsed.back();
  const std::vector<std::string> unexpected = verb.remaining();
  std::string text = error.what();
  if (parsed.empty() && unexpected.empty())
    text = fmt::format("name a verb, such as run; `{} help` lists them", program_);
  else if (!unexpected.empty() && (parsed.empty() || is_a<CLI::ExtrasError>(error)))
    text = sentence_on(verb, unexpected.front());
  else if (is_a<CLI::ArgumentMismatch>(error))
    text = sentence_on_values(verb, text.substr(0, text.find(':')));
  const std::string name = parsed.empty() ? "" : " " + verb.get_name();
  return fmt::format("{} (see {}{} --help)", text, program_, name);
}

int CommandLine::read(int count, char** arguments) {
  if (count > 1 && arguments[1][0] != '-') require_verb(arguments[1]);
  try {
    app_.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return runs_ ? app_.exit(error) : kGood;  // --help, --version
    throw UsageError(sentence_of(error));
  }
  return exit_code_;
}

}  // namespace

int parse_and_run(const std::string& program, int count, char** arguments, Session& session) {
  return CommandLine(program, session, true).read(count, arguments);
}

void parse_only(const std::string& program, int count, char** arguments) {
  Session none("", {});
  CommandLine(program, none, false).read(count, arguments);
}

RunArguments read_run_arguments(const std::string& program, const std::vector<std::string>& words) {
  std::vector<std::string> all = {program, "run"};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  Session none("", {});
  CommandLine line(program, none, false);
  line.read(static_cast<int>(arguments.size()), arguments.data());
  return line.run();
}

}  // namespace isoline::benchmarks
