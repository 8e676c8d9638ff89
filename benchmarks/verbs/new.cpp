// isoline new problem|optimizer NAME: writes a template of a user's own component, which builds and
// passes its checks.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/catalog.h"
#include "core/files.h"
#include "core/shell.h"
#include "core/text.h"

namespace isoline::benchmarks {

// The files of clients/start/ and core/foreign/.
std::string_view embedded_start_problem_cpp();
std::string_view embedded_start_optimizer_cpp();
std::string_view embedded_start_problem_c();
std::string_view embedded_start_optimizer_c();
std::string_view embedded_start_problem_py();
std::string_view embedded_start_optimizer_py();
std::string_view embedded_start_cmake();
std::string_view embedded_isoline_h();

namespace {

namespace fs = std::filesystem;

struct NewArguments {
  std::string kind, name;
  bool is_c = false, is_python = false;  // else C++
};

void declare(VerbArguments& verb, NewArguments& given) {
  verb.text("KIND", given.kind, "problem or optimizer").one_of({"problem", "optimizer"}).required();
  verb.text("NAME", given.name, "Name: lower-case letters, digits and hyphens").required();
  const Argument c = verb.flag("--c", given.is_c, "In C, for --plugin");
  verb.flag("--python", given.is_python, "In Python, for process[command=…]").excludes(c);
}

// A component's name as each place writes it: "my-chain", "my_chain", "MyChain", "My chain".
std::array<std::string, 4> spellings_of(const std::string& name) {
  std::string identifier = name, type, words = name;
  std::ranges::replace(identifier, '-', '_');
  std::ranges::replace(words, '-', ' ');
  const auto upper = [](char letter) { return static_cast<char>(std::toupper(letter)); };
  words[0] = upper(name[0]);
  for (std::size_t i = 0; i < name.size(); ++i)
    if (name[i] != '-') type += i == 0 || name[i - 1] == '-' ? upper(name[i]) : name[i];
  return {name, identifier, type, words};
}

void put(std::string& text, const std::string& before, const std::string& after) {
  for (std::size_t at = 0; (at = text.find(before, at)) != std::string::npos; at += after.size())
    text.replace(at, before.size(), after);
}

// The file of clients/start/ for a name, by way of a mark that no text has: a name may hold the one
// in that file.
std::string renamed(std::string_view start, const std::string& kind, const std::string& name) {
  std::string text(start);
  const auto from = spellings_of("my-" + kind), to = spellings_of(name);
  const auto mark = [](std::size_t form) { return std::string(1, static_cast<char>(1 + form)); };
  for (std::size_t form = 0; form < from.size(); ++form) put(text, from[form], mark(form));
  for (std::size_t form = 0; form < to.size(); ++form) put(text, mark(form), to[form]);
  return text;
}

void require_name(const std::string& name, const Catalog& catalog) {
  constexpr std::size_t kMost = 64;
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto is_allowed = [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '-';
  };
  const bool holds = is_letter(name[0]) && name.size() <= kMost && name.back() != '-' &&
                     name.find("--") == std::string::npos && std::ranges::all_of(name, is_allowed);
  require(holds, [&] {
    return fmt::format(
        "a name must consist of at most {} lower-case letters, digits and single hyphens, and "
        "must begin with a letter, got '{}'",
        kMost, name);
  });
  require(!catalog.problems.contains(name) && !catalog.optimizers.contains(name), [&] {
    return fmt::format("'{0}' exists already; `isoline describe {0}` shows it", name);
  });
}

// Where this is Isoline's own tree, its launcher builds.
bool is_in_the_tree() {
  return is_there("CMakeLists.txt") &&
         read_text("CMakeLists.txt").find("project(isoline ") != std::string::npos;
}

// A component in one language: its file, what it is built with, and what is to be done next.
struct Draft {
  std::string_view problem, optimizer;  // files of clients/start/
  fs::path file;
  fs::path besides;  // stays as it is where it exists; empty: none
  std::string_view besides_text;
  std::string next;  // in the words of a shell
};

// Configures a program of one's own with the Isoline that runs, which is installed first if this is
// a build folder.
std::string configure_command() {
  std::error_code unknown;
  const fs::path folder = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  const std::string configure = "cmake -S . -B build -DCMAKE_PREFIX_PATH=";
  if (folder.filename() == "bin") return configure + shell_word(folder.parent_path().string());
  return fmt::format("cmake --install {} --prefix $HOME/isoline && {}$HOME/isoline",
                     shell_word(folder.string()), configure);
}

Draft draft_of(const NewArguments& given, const std::string& identifier) {
  const bool is_problem = given.kind == "problem";
  const std::string use = (is_problem ? "check " : "audit ") + given.name;
  if (given.is_c)
    return {embedded_start_problem_c(),
            embedded_start_optimizer_c(),
            identifier + ".c",
            "isoline.h",
            embedded_isoline_h(),
            fmt::format("cc -O2 -shared -fPIC -o lib{0}.so {0}.c && isoline {1} --plugin "
                        "./lib{0}.so",
                        identifier, use)};
  if (given.is_python)  // needs no other file: the process adapter sets the path of isoline.py
    return {embedded_start_problem_py(),
            embedded_start_optimizer_py(),
            identifier + ".py",
            "",
            "",
            fmt::format("isoline {} 'process[command=\"python3 {}.py\"]'",
                        is_problem ? "check" : "run --problem rosenbrock --optimizer", identifier)};
  const std::string build = configure_command() + " && cmake --build build && build/mine ";
  return {embedded_start_problem_cpp(),
          embedded_start_optimizer_cpp(),
          fs::path(given.kind + "s") / (identifier + ".cpp"),
          "CMakeLists.txt",
          embedded_start_cmake(),
          (is_in_the_tree() ? "./isoline " : build) + use};
}

void write_new(const fs::path& path, std::string_view text) {
  if (is_there(path)) return;
  std::error_code error;  // the write below reports it
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  write_text(path, std::string(text));
  say(stdout, fmt::format("wrote {}\n", path.string()));
}

int run(const NewArguments& given, Session& session) {
  require_name(given.name, session.catalog());
  const Draft draft = draft_of(given, spellings_of(given.name)[1]);
  require(!is_there(draft.file), [&] {
    return fmt::format("{} exists already and is not overwritten", draft.file.string());
  });
  if (!draft.besides.empty()) write_new(draft.besides, draft.besides_text);
  write_new(draft.file, renamed(given.kind == "problem" ? draft.problem : draft.optimizer,
                                given.kind, given.name));
  say(stdout, fmt::format("next: {}\n", draft.next));
  return kGood;
}

}  // namespace

void register_new(VerbRegistry& registry) {
  registry.add(verb_of<NewArguments>(
      {.name = "new",
       .help_position = 180,
       .summary = "Write a template of your own problem or optimizer",
       .examples = "  isoline new problem my-chain                C++: problems/my_chain.cpp\n"
                   "  isoline new optimizer my-method --c         C: my_method.c, for --plugin\n"
                   "  isoline new problem my-simulator --python   Python: my_simulator.py",
       .notes = "The template builds and passes its checks. `new` also writes CMakeLists.txt or "
                "isoline.h "
                "if it is missing, and does not overwrite any file."},
      declare, run));
}

}  // namespace isoline::benchmarks
