// isoline completion bash: prints a script for the shell, with the names of problems and
// optimizers.
#include <fmt/format.h>

#include <string_view>

#include "benchmarks/cli/verb.h"
#include "core/status.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

struct CompletionArguments {
  std::string shell = "bash";
};

void declare(VerbArguments& verb, CompletionArguments& given) {
  verb.text("SHELL", given.shell, "bash").one_of({"bash"}).shown();
}

// Names come from the program at each completion, so that new components are known at once.
constexpr const char* kBash = R"(# bash completion for isoline:  source <(./isoline completion bash)
_isoline() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} verb=${COMP_WORDS[1]}
  local program=${COMP_WORDS[0]} list="" prefix=""
  case $before in
    --problem) list=$("$program" list problems --names 2>/dev/null) ;;
    --optimizer) list=$("$program" list optimizers --names 2>/dev/null) ;;
    --out|--from|--record) COMPREPLY=($(compgen -d -- "$word")); return ;;
    --plugin) COMPREPLY=($(compgen -f -- "$word")); return ;;
    --retry) list="@STATUSES@" ;;
    --rates) COMPREPLY=($(compgen -W "builtin none" -- "$word") $(compgen -f -- "$word")); return ;;
  esac
  if [[ -n $list ]]; then
    [[ $word == *,* ]] && prefix=${word%,*},
    COMPREPLY=($(compgen -P "$prefix" -W "$list" -- "${word##*,}"))
    return
  fi
  if [[ $COMP_CWORD -eq 1 ]]; then
    COMPREPLY=($(compgen -W "@VERBS@ --help --version" -- "$word"))
    return
  fi
  case $word in
    -*) list=$("$program" "$verb" --help 2>/dev/null | grep -oE -- '--[a-z-]+' | sort -u) ;;
    *) case $verb in
         run|plan|submit) list=$("$program" list suites --names 2>/dev/null) ;;
         describe) list=$("$program" list all --names 2>/dev/null) ;;
         check) list=$("$program" list problems --names 2>/dev/null) ;;
         claims) list=$("$program" claims --list --all 2>/dev/null | grep -oE '^  [a-z0-9-]+') ;;
         help) list="@VERBS@" ;;
         new) list="problem optimizer" ;;
         list) list="problems networks optimizers suites all" ;;
         completion) list=bash ;;
         *) COMPREPLY=($(compgen -f -- "$word")); return ;;
       esac ;;
  esac
  COMPREPLY=($(compgen -W "$list" -- "$word"))
}
complete -o nosort -F _isoline isoline ./isoline
)";

void put(std::string& script, std::string_view place, const std::string& text) {
  for (std::size_t at; (at = script.find(place)) != std::string::npos;)
    script.replace(at, place.size(), text);
}

int run(const CompletionArguments&, Session&) {
  std::string verbs, statuses, script = kBash;
  for (const Verb& verb : all_verbs()) verbs += verb.name + " ";
  for (const std::string_view status : kStatusNames)
    if (status != name_of(Status::running)) statuses += fmt::format("{} ", status);
  put(script, "@VERBS@", verbs);
  put(script, "@STATUSES@", statuses);
  say(stdout, script);
  return kGood;
}

}  // namespace

void register_completion(VerbRegistry& registry) {
  registry.add(verb_of({.name = "completion",
                        .help_position = 240,
                        .summary = "Print the completion script for a shell",
                        .examples = "  isoline completion bash > ~/.isoline-completion"},
                       declare, run));
}

}  // namespace isoline::benchmarks
