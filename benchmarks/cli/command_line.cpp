// Parses the command line with CLI11, which no other file uses, and states what is wrong with it.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>

#include "benchmarks/cli/verb.h"
#include "core/columns.h"
#include "core/errors.h"
#include "core/records/provenance.h"
#include "core/spec.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

constexpr const char* kAbout =
    "Isoline compares optimizers on inverse problems in physics. It runs every optimizer on every "
    "problem, writes one JSON record per run, and reports the results.";
constexpr const char* kExamples =
    "Examples:\n"
    "  isoline run                        the default suite, then its report\n"
    "  isoline run --problem 'sine[xi=1|32]' --optimizer adam,ceres-lm --seeds 5\n"
    "  isoline run quick --optimizer adam     only the cells with this optimizer\n"
    "  isoline describe sip               formula, options, required derivatives\n"
    "  isoline check rosenbrock           are the derivatives of a problem correct?\n"
    "  isoline audit gd adam sip          measured scaling, invariance and order\n"
    "  isoline compare results/old results/new    what is worse than before?\n"
    "  isoline claims notebook            do the claims of the notebook hold?\n"
    "  isoline help run                   the options of a command, with examples\n\n"
    "Exit codes: 0 success, 1 usage error, 2 failed cells or a regression, 3 improvements only, "
    "4 not comparable, 130 interrupted.";

// The groups of verbs in the help: the greatest help_position of each.
struct VerbGroup {
  int last;
  const char* title;
};
constexpr VerbGroup kGroups[] = {{29, "Run cells"},
                                 {129, "Read results"},
                                 {199, "Problems and optimizers"},
                                 {229, "Tune and train"},
                                 {299, "The program itself"}};

const char* group_of(const Verb& verb) {
  return std::ranges::find_if(
             kGroups, [&](const VerbGroup& group) { return verb.help_position <= group.last; })
      ->title;
}

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number value{};
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size()) return std::nullopt;
  return value;
}

constexpr double kKilo = 1024;
constexpr std::string_view kUnits = "kmgt";

// The unit that the text ends with, which is taken off: "", "b", "g", "gb" or "gib".
double unit_of(std::string& text) {
  for (const std::string_view end : {"ib", "b"})
    if (text.ends_with(end)) {
      text.resize(text.size() - end.size());
      break;
    }
  const std::size_t unit = text.empty() ? kUnits.npos : kUnits.find(text.back());
  if (unit == kUnits.npos) return 1;
  text.pop_back();
  return std::pow(kKilo, unit + 1);
}

// Complete numbers: no sign is dropped and nothing clamped. UsageError, which begins with `option`,
// if the text is not a number or is out of range.
std::int64_t read_whole(const std::string& option, const std::string& text, WholeRange range) {
  const auto value = number_in<std::int64_t>(text);
  require(value && *value >= range.low && *value <= range.high, [&] {
    return fmt::format("{} must be a whole number from {} to {}, got '{}'", option, range.low,
                       count_text(static_cast<std::uint64_t>(range.high)), text);
  });
  return *value;
}

std::uint64_t read_seed(const std::string& option, const std::string& text) {
  const auto value = number_in<std::uint64_t>(text);
  require(value.has_value(), [&] {
    return fmt::format("{} must be a whole number from 0 to {}, got '{}'", option,
                       std::numeric_limits<std::uint64_t>::max(), text);
  });
  return *value;
}

double read_real(const std::string& option, const std::string& text, const Range& range) {
  const auto value = number_in<double>(text);
  require(value && contains(range, *value), [&] {
    return fmt::format("{} must be a number in {}, got '{}'", option, range_text(range), text);
  });
  return *value;
}

// Seconds, of "2m".
double read_time(const std::string& option, const std::string& text) {
  try {
    return parse_duration(text);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", option, error.what()));
  }
}

// "2GB", "1.5GiB" or bytes; a unit is 1024 of the one before. Less than 16MB starts no cell.
std::int64_t read_bytes(const std::string& option, const std::string& text, int least_megabytes) {
  const double least = least_megabytes * kKilo * kKilo, most = std::pow(kKilo, 5);
  std::string amount = text;
  for (char& letter : amount)
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  const double unit = unit_of(amount);
  const auto value = number_in<double>(amount);
  const double bytes = value ? *value * unit : -1;
  require(bytes >= least && bytes <= most, [&] {
    return fmt::format("{} must be a size between {}MB and 1024TB, such as 2GB, got '{}'", option,
                       least_megabytes, text);
  });
  return static_cast<std::int64_t>(bytes);
}

std::string refuse_empty(std::string& text) { return text.empty() ? "it must not be empty" : ""; }

// One function per type keeps CLI11's templates out of the verbs, where each call would instantiate
// them again.
template <class Value>
[[gnu::noinline]] CLI::Option* option(CLI::App& verb, const char* name, Value& value,
                                      const char* about) {
  return verb.add_option(name, value, about)->check(CLI::Validator(refuse_empty, ""));
}

// A number that `read` reads, given the option's name and the text.
template <class Value, class Read>
CLI::Option* number(CLI::App& verb, const char* name, const char* type, Value& value,
                    const char* about, const Read& read) {
  const std::function<void(const std::string&)> set = [=, &value](const std::string& text) {
    value = static_cast<Value>(read(name, text));
  };
  return verb.add_option_function(name, set, about)->type_name(type);
}

template <class Value>
CLI::Option* whole_number(CLI::App& verb, const char* name, Value& value, const char* about,
                          WholeRange range) {
  CLI::Option* made = number(verb, name, "INT", value, about,
                             [range](auto& of, auto& text) { return read_whole(of, text, range); });
  if (value >= range.low) made->default_str(std::to_string(value));
  return made;
}

std::vector<std::string> option_names(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

// For an option without a value, or with two values where it takes one.
std::string value_complaint(const CLI::App& verb, const std::string& name) {
  const CLI::Option* option = verb.get_option_no_throw(name);
  const bool is_repeated = option != nullptr && option->count() > 1;
  return name + (is_repeated ? " occurs more than once" : " needs a value");
}

// For the first argument that CLI11 could not place.
std::string argument_complaint(const CLI::App& verb, const std::string& unexpected) {
  if (!unexpected.starts_with('-'))
    return fmt::format("{}: unexpected argument '{}'", verb.get_name(), unexpected);
  const std::string name = unexpected.substr(0, unexpected.find('='));
  for (const CLI::Option* option : verb.get_options()) {  // what has no name stands alone
    std::string place = option->get_positional() ? option->get_single_name() : "";
    std::ranges::transform(place, place.begin(), [](unsigned char c) { return std::tolower(c); });
    if ("--" + place == name)
      return fmt::format("unknown option {}; give its value alone: {} {}", name, verb.get_name(),
                         option->get_single_name());
  }
  const std::string nearest = nearest_name(name, option_names(verb));
  return fmt::format("unknown option {}{}", name,
                     nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest));
}

template <class Kind>
bool is_a(const CLI::ParseError& error) {
  return dynamic_cast<const Kind*>(&error) != nullptr;
}

// Help text that fits the terminal, and 80 columns elsewhere. Examples stay whole, to be copied.
struct WrappedHelp : CLI::Formatter {
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    constexpr std::size_t kUsual = 80, kLeast = 50;
    const std::size_t columns = terminal_width(STDOUT_FILENO);
    const std::size_t most = columns >= kLeast ? columns : kUsual;
    return fitted_text(CLI::Formatter::make_help(app, std::move(name), mode), most);
  }
};

class CommandLine {
 public:
  // `runs`: or only reads.
  CommandLine(const std::string& program, Session& session, bool runs);
  int read(std::vector<std::string> words);  // and runs; the exit code

 private:
  void declare(const Verb& verb);
  void require_verb(const std::string& name) const;
  std::string help_text() const;
  std::string complaint(const CLI::ParseError& error) const;

  const std::string program_;
  std::vector<Verb> verbs_;
  Session& session_;
  const bool runs_;
  CLI::App app_;
  std::string helped_;  // the argument of `help`; empty: the program
  int exit_code_ = kGood;
};

CommandLine::CommandLine(const std::string& program, Session& session, bool runs)
    : program_(program),
      verbs_(all_verbs()),
      session_(session),
      runs_(runs),
      app_(kAbout, program) {
  app_.formatter(std::make_shared<WrappedHelp>());
  app_.footer(kExamples);
  app_.set_version_flag("--version", "isoline " + version());
  app_.require_subcommand(1);
  app_.get_formatter()->label("SUBCOMMAND", "COMMAND");
  for (Verb& verb : verbs_) {
    if (verb.name == "help") {
      verb.declare = [this](VerbArguments& arguments) {
        arguments.text("COMMAND", helped_, "The command (default: the program)");
      };
      verb.run = [this](Session&) {
        say(stdout, help_text());
        return kGood;
      };
    }
    declare(verb);
  }
}

void CommandLine::declare(const Verb& verb) {
  CLI::App& declared = *app_.add_subcommand(verb.name, verb.summary);
  VerbArguments arguments(declared, session_);
  if (verb.declare) verb.declare(arguments);
  const char* between = verb.notes.empty() ? "" : "\n\n";
  declared.footer(fmt::format("Examples:\n{}{}{}", verb.examples, between, verb.notes))
      ->group(verb.is_hidden ? "" : group_of(verb));
  declared.callback([this, &verb] {
    if (!helped_.empty()) require_verb(helped_);
    if (runs_) exit_code_ = verb.run(session_);
  });
}

// Uses the formatter, since App::help() would print the help of the verb `help`.
std::string CommandLine::help_text() const {
  const CLI::App& of = helped_.empty() ? app_ : *app_.get_subcommand(helped_);
  const std::string name = helped_.empty() ? program_ : program_ + " " + helped_;
  return app_.get_formatter()->make_help(&of, name, CLI::AppFormatMode::Normal);
}

void CommandLine::require_verb(const std::string& name) const {
  std::vector<std::string> known;
  std::string meant;  // the command that its summary says to do this
  for (const Verb& verb : verbs_) {
    known.push_back(verb.name);
    if (meant.empty() && name.size() > 3 && verb.summary.find(name) != std::string::npos)
      meant = verb.name;
  }
  require(std::ranges::find(known, name) != known.end(), [&] {
    return nearest_name(name, known).empty() && !meant.empty()
               ? fmt::format("unknown command '{}'; did you mean '{}'?", name, meant)
               : unknown_name("command", name, known);
  });
}

std::string CommandLine::complaint(const CLI::ParseError& error) const {
  const std::vector<const CLI::App*> parsed =
      app_.get_subcommands([](const CLI::App* verb) { return verb->parsed(); });
  const CLI::App& verb = parsed.empty() ? app_ : *parsed.back();
  std::vector<std::string> unexpected = verb.remaining();
  if (unexpected.empty()) unexpected = app_.remaining();  // behind --
  std::string text = error.what();
  if (parsed.empty() && unexpected.empty())
    text = fmt::format("a command is missing, such as run; `{} help` lists the commands", program_);
  else if (!unexpected.empty() && (parsed.empty() || is_a<CLI::ExtrasError>(error)))
    text = argument_complaint(verb, unexpected.front());
  else if (const std::size_t at = text.find(" excludes "); at != text.npos)
    text.replace(at, 10, " cannot be combined with ");
  else if (text.ends_with("flag override"))
    text = fmt::format("--{} takes no value", text.substr(0, text.find(' ')));
  else if (is_a<CLI::ArgumentMismatch>(error))
    text = value_complaint(verb, text.substr(0, text.find(':')));
  const std::string name = parsed.empty() ? "" : " " + verb.get_name();
  return fmt::format("{} (see {}{} --help)", text, program_, name);
}

int CommandLine::read(std::vector<std::string> words) {
  if (words.empty()) {
    if (runs_) say(stdout, help_text());
    return kGood;
  }
  if (!words.front().starts_with('-')) require_verb(words.front());
  std::ranges::reverse(words);  // as CLI11 takes them
  try {
    app_.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return runs_ ? app_.exit(error) : kGood;  // --help, --version
    throw UsageError(complaint(error));
  }
  return exit_code_;
}

}  // namespace

int parse_and_run(const std::string& program, int count, char** arguments, Session& session) {
  std::vector<std::string> words(arguments + 1, arguments + count);
  return CommandLine(program, session, true).read(present_words(std::move(words), program));
}

void parse_only(const std::string& program, int count, char** arguments) {
  Session none("", {});
  CommandLine(program, none, false).read({arguments + 1, arguments + count});
}

std::vector<Verb> all_verbs() {
  VerbRegistry registry("verb");
  register_verbs(registry);
  std::vector<Verb> verbs;
  for (const auto& [name, verb] : registry) verbs.push_back(verb);
  std::ranges::stable_sort(verbs, {}, &Verb::help_position);
  verbs.push_back({.name = "help",
                   .help_position = 280,
                   .summary = "Print the help of the program or of a command",
                   .examples = "  isoline help\n  isoline help run"});
  verbs.push_back({.name = "version",
                   .help_position = 290,
                   .summary = "Print the version",
                   .examples = "  isoline version",
                   .run = [](Session&) {
                     say(stdout, fmt::format("isoline {}\n", version()));
                     return kGood;
                   }});
  return verbs;
}

std::string program_examples() { return kExamples; }
std::string program_summary() { return kAbout; }

std::vector<ArgumentText> arguments_of(const Verb& verb) {
  Session none("", {});
  CLI::App declared(verb.summary, verb.name);
  VerbArguments arguments(declared, none);
  if (verb.declare) verb.declare(arguments);
  std::vector<ArgumentText> all;
  for (const CLI::Option* option : declared.get_options()) {
    const auto choices = arguments.choices().find(option);
    all.push_back({.name = option->get_name(true),
                   .value = option->get_items_expected_max() > 0 ? option->get_type_name() : "",
                   .about = option->get_description(),
                   .choices = choices == arguments.choices().end() ? std::vector<std::string>()
                                                                   : choices->second});
    if (!option->get_lnames().empty()) all.back().name = "--" + option->get_lnames().front();
  }
  return all;
}

// --- arguments

Argument Argument::required() const {
  option_->required();
  return *this;
}

Argument Argument::shown() const {
  option_->capture_default_str();
  return *this;
}

Argument Argument::shown(const std::string& standard) const {
  option_->default_str(standard);
  return *this;
}

Argument Argument::one_of(const std::vector<std::string>& names) const {
  const auto refuse = [names](const std::string& given) {
    const bool is_known = std::ranges::find(names, given) != names.end();
    return is_known ? "" : unknown_name("value", given, names);
  };
  option_->check(refuse);
  (*choices_)[option_] = names;
  return *this;
}

Argument Argument::between_commas() const {
  option_->delimiter(',')->allow_extra_args(false);
  return *this;
}

Argument Argument::one_each() const {
  option_->allow_extra_args(false);
  return *this;
}

Argument Argument::may_be_empty() const {
  option_->get_validator("")->active(false);  // refuse_empty, the first validator of every option
  return *this;
}

Argument Argument::joined() const {
  option_->join(',');
  return *this;
}

Argument Argument::needs(const Argument& other) const {
  option_->needs(other.option_);
  return *this;
}

Argument Argument::excludes(const Argument& other) const {
  option_->excludes(other.option_);
  return *this;
}

Argument VerbArguments::text(const char* name, std::string& value, const char* about) {
  return argument(*option(verb_, name, value, about));
}

Argument VerbArguments::texts(const char* name, std::vector<std::string>& values,
                              const char* about) {
  return argument(*option(verb_, name, values, about));
}

Argument VerbArguments::flag(const char* name, bool& value, const char* about) {
  return argument(*verb_.add_flag(name, value, about)->disable_flag_override());
}

Argument VerbArguments::whole(const char* name, int& value, const char* about, WholeRange range) {
  return argument(*whole_number(verb_, name, value, about, range));
}

Argument VerbArguments::whole(const char* name, std::int64_t& value, const char* about,
                              WholeRange range) {
  return argument(*whole_number(verb_, name, value, about, range));
}

void VerbArguments::whole_or_never(const char* name, std::int64_t& value, const char* about) {
  number(verb_, name, "N|never", value, about, [](auto& of, auto& text) {
    return text == "never" ? std::int64_t{0} : read_whole(of, text, {});
  });
}

Argument VerbArguments::real(const char* name, double& value, const Range& range,
                             const char* about) {
  return argument(*number(verb_, name, "FLOAT", value, about,
                          [range](auto& of, auto& text) { return read_real(of, text, range); }));
}

void VerbArguments::seed(const char* name, std::uint64_t& value, const char* about) {
  number(verb_, name, "UINT", value, about, read_seed)->default_str(std::to_string(value));
}

void VerbArguments::time(const char* name, double& seconds, const char* about) {
  number(verb_, name, "TIME", seconds, about, read_time);
}

void VerbArguments::memory(const char* name, std::int64_t& bytes, const char* about,
                           int least_megabytes) {
  number(verb_, name, "SIZE", bytes, about,
         [=](auto& of, auto& text) { return read_bytes(of, text, least_megabytes); });
}

void VerbArguments::plugins() {
  texts("--plugin", session_.plugins(),
        "Shared library with further problems and optimizers; may be used "
        "more than once")
      .one_each();
}

}  // namespace isoline::benchmarks
