// isoline man: prints the manual page of the program, in the macros of man(7), by the declarations
// of the verbs.
#include <fmt/format.h>

#include <sstream>

#include "benchmarks/cli/verb.h"
#include "core/records/provenance.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

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

void register_man(VerbRegistry& registry) {
  registry.add(verb_of({.name = "man",
                        .help_position = 250,
                        .summary = "Print the manual page",
                        .examples = "  isoline man > isoline.1 && man ./isoline.1"},
                       declare, run));
}

}  // namespace isoline::benchmarks
