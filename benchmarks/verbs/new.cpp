// isoline new problem|optimizer NAME: the file that a component of one's own starts from. It builds
// and passes its checks as it is written.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <vector>

#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/catalog.h"
#include "core/files.h"
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

// A component's name as each place writes it.
struct Spelling {
  std::string name, identifier, type, words;  // "my-chain", "my_chain", "MyChain", "My chain"
};

Spelling spelling_of(const std::string& name) {
  Spelling all{.name = name, .identifier = name, .words = name};
  std::ranges::replace(all.identifier, '-', '_');
  std::ranges::replace(all.words, '-', ' ');
  const auto upper = [](char letter) { return static_cast<char>(std::toupper(letter)); };
  all.words[0] = upper(name[0]);
  for (std::size_t i = 0; i < name.size(); ++i)
    if (name[i] != '-') all.type += i == 0 || name[i - 1] == '-' ? upper(name[i]) : name[i];
  return all;
}

// The name of the component in the files of clients/start/.
Spelling spelling_in_start(const std::string& kind) { return spelling_of("my-" + kind); }

void put(std::string& text, const std::string& before, const std::string& after) {
  for (std::size_t at = 0; (at = text.find(before, at)) != std::string::npos; at += after.size())
    text.replace(at, before.size(), after);
}

// By way of a mark that no text has: a name may hold the other one.
std::string renamed(std::string_view start, const Spelling& from, const Spelling& to) {
  std::string text(start);
  const std::string Spelling::*forms[] = {&Spelling::name, &Spelling::identifier, &Spelling::type,
                                          &Spelling::words};
  const auto mark = [](std::size_t form) { return std::string(1, static_cast<char>(1 + form)); };
  for (std::size_t form = 0; form < std::size(forms); ++form)
    put(text, from.*forms[form], mark(form));
  for (std::size_t form = 0; form < std::size(forms); ++form)
    put(text, mark(form), to.*forms[form]);
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
        "a name must be lower-case letters, digits and single hyphens between them, "
        "{} at most and the first a letter, got '{}'",
        kMost, name);
  });
  require(!catalog.problems.contains(name) && !catalog.optimizers.contains(name), [&] {
    return fmt::format("'{0}' exists already; `isoline describe {0}` shows it", name);
  });
}

// A file that is written unless it exists.
struct Draft {
  fs::path path;
  std::string text;
};

// All that is to be done next, in the words of a shell.
struct Beginning {
  Draft file;
  std::vector<Draft> besides;  // what it is built with; what is there already stays as it is
  std::string next;
};

Beginning begin_c(const std::string& kind, const Spelling& to) {
  const bool is_problem = kind == "problem";
  const std::string_view start =
      is_problem ? embedded_start_problem_c() : embedded_start_optimizer_c();
  const std::string use = is_problem ? "check " + to.name : "audit " + to.name;
  return {.file = {to.identifier + ".c", renamed(start, spelling_in_start(kind), to)},
          .besides = {{"isoline.h", std::string(embedded_isoline_h())}},
          .next = fmt::format("cc -O2 -shared -fPIC -o lib{0}.so {0}.c && isoline {1} --plugin "
                              "./lib{0}.so",
                              to.identifier, use)};
}

// A script needs no other file: the process adapter sets the path of isoline.py.
Beginning begin_python(const std::string& kind, const Spelling& to) {
  const bool is_problem = kind == "problem";
  const std::string_view start =
      is_problem ? embedded_start_problem_py() : embedded_start_optimizer_py();
  const std::string use = is_problem ? "check" : "run --problem rosenbrock --optimizer";
  return {
      .file = {to.identifier + ".py", renamed(start, spelling_in_start(kind), to)},
      .besides = {},
      .next = fmt::format("isoline {} 'process[command=\"python3 {}.py\"]'", use, to.identifier)};
}

// Where this is Isoline's own tree, its launcher builds.
bool is_in_the_tree() {
  return is_there("CMakeLists.txt") &&
         read_text("CMakeLists.txt").find("project(isoline ") != std::string::npos;
}

Beginning begin_cpp(const std::string& kind, const Spelling& to) {
  const bool is_problem = kind == "problem";
  const std::string_view start =
      is_problem ? embedded_start_problem_cpp() : embedded_start_optimizer_cpp();
  const std::string use = is_problem ? "check " + to.name : "audit " + to.name;
  const std::string build = "cmake -S . -B build && cmake --build build && build/mine ";
  return {.file = {fs::path(kind + "s") / (to.identifier + ".cpp"),
                   renamed(start, spelling_in_start(kind), to)},
          .besides = {{"CMakeLists.txt", std::string(embedded_start_cmake())}},
          .next = (is_in_the_tree() ? "./isoline " : build) + use};
}

int run(const NewArguments& given, Session& session) {
  require_name(given.name, session.catalog());
  const Spelling to = spelling_of(given.name);
  const Beginning begun = given.is_c        ? begin_c(given.kind, to)
                          : given.is_python ? begin_python(given.kind, to)
                                            : begin_cpp(given.kind, to);
  require(!is_there(begun.file.path), [&] {
    return fmt::format("{} exists already and is not overwritten", begun.file.path.string());
  });
  std::vector<Draft> drafts = begun.besides;
  drafts.push_back(begun.file);
  for (const Draft& draft : drafts) {
    if (is_there(draft.path)) continue;
    std::error_code error;  // the write below reports it
    if (draft.path.has_parent_path()) fs::create_directories(draft.path.parent_path(), error);
    write_text(draft.path, draft.text);
    say(stdout, fmt::format("wrote {}\n", draft.path.string()));
  }
  say(stdout, fmt::format("next: {}\n", begun.next));
  return kGood;
}

}  // namespace

void register_new(VerbRegistry& registry) {
  registry.add(verb_of(
      {.name = "new",
       .help_position = 180,
       .summary = "Write a file to start your own problem or optimizer from",
       .examples =
           "  isoline new problem my-chain                 problems/my_chain.cpp, for a program "
           "of your own\n"
           "  isoline new optimizer my-method --c          my_method.c, for a library\n"
           "  isoline new problem my-simulator --python    my_simulator.py, for a process",
       .notes =
           "The file builds and passes its checks as it is; nothing is overwritten. `new` also "
           "writes\n"
           "CMakeLists.txt or isoline.h if it is missing."},
      declare, run));
}

}  // namespace isoline::benchmarks
