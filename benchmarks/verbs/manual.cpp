// Files of packages, made from the declarations of the verbs. isoline man: the manual page, in
// the macros of man(7). isoline completion SHELL: a script for a shell, which calls `isoline
// completion words` to complete the last of the given words.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/claim_cells.h"
#include "core/records/provenance.h"
#include "core/status.h"
#include "core/text.h"
#include "networks/network_entry.h"

namespace isoline::benchmarks {
namespace {

struct CompletionArguments {
  std::string shell = "bash";
  std::vector<std::string> words;
};

void declare(VerbArguments& verb, CompletionArguments& given) {
  verb.text("SHELL", given.shell,
            "The shell of the script; or words, which completes the last WORD after --")
      .one_of({"bash", "zsh", "fish", "words"})
      .shown();
  verb.texts("WORD", given.words, "Words of a command line, without the name of the program")
      .may_be_empty();
}

// Each script completes files if the program does not know any candidate.
constexpr const char* kBash = R"(# bash completion for isoline:  source <(./isoline completion bash)
_isoline() {
  local IFS=$'\n'
  COMPREPLY=($("${COMP_WORDS[0]}" completion words -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null |
    cut -f 1))
}
complete -o nosort -o default -F _isoline isoline ./isoline
)";

constexpr const char* kZsh = R"(#compdef isoline
# zsh completion for isoline:  source <(./isoline completion zsh)
_isoline() {
  local -a names texts
  local line
  "$words[1]" completion words -- "${(@)words[2,CURRENT]}" 2>/dev/null |
    while IFS= read -r line; do
      names+=("${line%%$'\t'*}")
      texts+=("${line/$'\t'/  -- }")
    done
  if (( $#names )); then compadd -l -d texts -a names; else _files; fi
}
if [[ $funcstack[1] == _isoline ]]; then _isoline; else compdef _isoline isoline; fi
)";

constexpr const char* kFish = R"(# fish completion for isoline:  ./isoline completion fish | source
function __isoline_complete
  set -l words (commandline -opc)
  set -l found ($words[1] completion words -- $words[2..] (commandline -ct) 2>/dev/null)
  if test (count $found) -gt 0
    printf '%s\n' $found
  else
    __fish_complete_path (commandline -ct)
  end
end
complete -c isoline -f -a '(__isoline_complete)'
)";

using Candidates = std::vector<std::pair<std::string, std::string>>;  // names and what they are

template <class Registry>
void add_names(Candidates& all, const Registry& registry) {
  for (const auto& [name, entry] : registry) all.emplace_back(name, entry.title);
}

Candidates verbs() {
  Candidates all;
  for (const Verb& verb : all_verbs())
    if (!verb.is_hidden) all.emplace_back(verb.name, verb.summary);
  return all;
}

// Values of an argument of the verb; none where they are files or free text.
Candidates values_of(const Verb& verb, const ArgumentText& argument, Session& session) {
  Candidates all;
  const auto is = [&](std::initializer_list<const char*> names) {
    return std::ranges::find(names, argument.name) != names.end();
  };
  for (const std::string& choice : argument.choices) all.emplace_back(choice, "");
  const bool has_any = verb.name == "describe" && is({"NAME"});
  if (has_any || is({"--problem", "PROBLEM", "SPEC"})) add_names(all, session.catalog().problems);
  if (has_any || is({"--optimizer", "OPTIMIZER", "--instead"}))
    add_names(all, session.catalog().optimizers);
  if (has_any) add_names(all, networks::network_registry());
  if (is({"SUITE", "--suite"}))
    for (const auto& [name, text] : builtin_suites()) all.emplace_back(name, "");
  if (verb.name == "claims" && is({"ID"}))
    for (const Claim& claim : session.claims()) all.emplace_back(claim.id, claim.sentence);
  if (is({"--retry"}))
    for (const std::string_view status : kStatusNames)
      if (status != name_of(Status::running)) all.emplace_back(status, "");
  if (is({"--rates"})) all = {{"builtin", ""}, {"none", ""}};
  return all;
}

// The candidates for the last of the words, whatever it begins with.
Candidates candidates_for(const std::vector<std::string>& words, Session& session) {
  if (words.size() < 2) {
    Candidates all = verbs();
    all.insert(all.end(), {{"--help", ""}, {"--version", ""}});
    return all;
  }
  if (words.front() == "help") return verbs();
  const std::vector<Verb> known = all_verbs();
  const auto verb = std::ranges::find(known, words.front(), &Verb::name);
  if (verb == known.end()) return {};
  const std::vector<ArgumentText> arguments = arguments_of(*verb);
  const auto before = std::ranges::find(arguments, words[words.size() - 2], &ArgumentText::name);
  if (words.size() > 2 && before != arguments.end() && !before->value.empty())
    return values_of(*verb, *before, session);
  Candidates all;
  for (const ArgumentText& argument : arguments) {
    const bool is_option = argument.name.starts_with("--");
    if (is_option && words.back().starts_with('-')) all.emplace_back(argument.name, argument.about);
    if (!is_option && !words.back().starts_with('-'))
      return values_of(*verb, argument, session);  // of the first positional argument
  }
  return all;
}

// One line for each candidate that the last word begins: its name, a tab, and what it is. Of a list
// such as gd,adam, the last name is completed.
int print_candidates(std::vector<std::string> words, Session& session) {
  if (words.empty()) words.emplace_back();
  const std::string& last = words.back();
  const Candidates all = candidates_for(words, session);
  const std::size_t comma = last.rfind(',');
  const std::string list = comma == last.npos ? "" : last.substr(0, comma + 1);
  for (const auto& [name, about] : all)
    if ((list + name).starts_with(last))
      say(stdout, fmt::format("{}{}\t{}\n", list, name, printable(about)));
  return kGood;
}

int run(const CompletionArguments& given, Session& session) {
  if (given.shell == "words") return print_candidates(given.words, session);
  say(stdout, given.shell == "bash" ? kBash : given.shell == "zsh" ? kZsh : kFish);
  return kGood;
}

// --- the manual page

// Text that roff prints as it is.
std::string escaped(const std::string& text) {
  std::string line;
  for (const char letter : text)
    line += letter == '\\' ? "\\e" : letter == '-' ? "\\-" : std::string(1, letter);
  return line.starts_with('.') || line.starts_with('\'') ? "\\&" + line : line;
}

std::string bold(const std::string& text) { return "\\fB" + escaped(text) + "\\fR"; }

// Lines that stay as they are.
std::string verbatim(const std::string& text) {
  std::string lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines += escaped(line) + "\n";
  return ".PP\n.nf\n" + lines + ".fi\n";
}

std::string verb_text(const Verb& verb) {
  std::string names, text;
  for (const ArgumentText& argument : arguments_of(verb)) {
    const bool is_option = argument.name.starts_with("--");
    if (!is_option) names += " [" + argument.name + "]";
    std::string head = bold(argument.name), choices;
    if (is_option && !argument.value.empty()) head += " " + escaped(argument.value);
    for (const std::string& choice : argument.choices)
      choices += (choices.empty() ? "" : ", ") + choice;
    text += ".TP\n" + head + "\n" + escaped(argument.about) + "\n";
    if (!choices.empty()) text += escaped("Values: " + choices + ".") + "\n";
  }
  const std::string notes = verb.notes.empty() ? "" : ".PP\n" + escaped(verb.notes) + "\n";
  return fmt::format(".SS isoline {}{} [OPTIONS]\n{}.\n{}{}{}", escaped(verb.name), escaped(names),
                     escaped(verb.summary), text, verbatim(verb.examples), notes);
}

struct ManArguments {};
void declare(VerbArguments&, ManArguments&) {}

int run(const ManArguments&, Session&) {
  std::string text = fmt::format(
      ".TH ISOLINE 1 \"\" \"isoline {}\"\n.SH NAME\nisoline \\- compare optimizers on physical "
      "inverse problems\n.SH SYNOPSIS\n{} COMMAND [ARGUMENTS]\n.SH DESCRIPTION\n{}\n.SH COMMANDS\n",
      version(), bold("isoline"), escaped(program_summary()));
  for (const Verb& verb : all_verbs()) text += verb_text(verb);
  say(stdout, text + ".SH EXAMPLES\n" + verbatim(program_examples()));
  return kGood;
}

}  // namespace

void register_manual(VerbRegistry& registry) {
  registry.add(verb_of<CompletionArguments>(
      {.name = "completion",
       .help_position = 240,
       .is_hidden = true,
       .summary = "Print the completion script for bash, zsh or fish",
       .examples = "  isoline completion bash > ~/.isoline-completion\n"
                   "  isoline completion words -- run --optimizer newt"},
      declare, run));
  registry.add(verb_of<ManArguments>({.name = "man",
                                      .help_position = 250,
                                      .is_hidden = true,
                                      .summary = "Print the manual page",
                                      .examples = "  isoline man > isoline.1 && man ./isoline.1"},
                                     declare, run));
}

}  // namespace isoline::benchmarks
