// Every registered component describes itself in the file of its name; one type has one name; the
// examples in the help are valid commands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/catalog.h"
#include "networks/network.h"
#include "tests/benchmarks/builtin.h"
#include "tests/refusal.h"
#include "tests/structure/sources.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {
using networks::network_registry;
using optimizers::register_optimizers;
using problems::register_problems;

namespace {

// The files of a room that register something.
std::vector<Source> component_files(const std::string& room) {
  std::vector<Source> files;
  for (const Source& source : sources()) {
    if (source.room() != room || source.is_header()) continue;
    if (source.text.find("void register_" + source.stem() + "(") == std::string::npos) continue;
    files.push_back(source);
  }
  return files;
}

// A file is named after its entry, or its entries begin with its name, or it quotes their names.
bool belongs(const std::string& entry, const Source& file) {
  std::string name = file.stem();
  std::ranges::replace(name, '_', '-');
  return entry == name || entry.starts_with(name + "-") ||
         file.text.find("\"" + entry + "\"") != std::string::npos;
}

template <class Entries>
void expect_files_and_entries_agree(const std::string& room, const Entries& entries) {
  const std::vector<Source> files = component_files(room);
  EXPECT_GE(files.size(), 3U) << room << ": the components were not found";
  for (const auto& [name, entry] : entries)
    EXPECT_TRUE(std::ranges::any_of(files, [&](const auto& file) { return belongs(name, file); }))
        << name << " is in no file of " << room;
  for (const Source& file : files)
    EXPECT_TRUE(std::ranges::any_of(entries, [&](const auto& e) { return belongs(e.first, file); }))
        << room << "/" << file.stem() << " names nothing that it adds";
}

TEST(Components, AreInFilesThatNameThem) {
  expect_files_and_entries_agree("problems", catalog().problems);
  expect_files_and_entries_agree("optimizers", catalog().optimizers);
  expect_files_and_entries_agree("networks", network_registry());
}

template <class Entry>
void expect_described(const Entry& entry) {
  EXPECT_FALSE(entry.title.empty()) << entry.name;
  EXPECT_FALSE(entry.formula.empty()) << entry.name;
  EXPECT_FALSE(entry.source.empty()) << entry.name;
  std::set<std::string> options;
  for (const OptionField& option : entry.options) {
    EXPECT_FALSE(option.doc.empty()) << entry.name << ": " << option.name;
    EXPECT_TRUE(options.insert(option.name).second) << entry.name << ": " << option.name;
    EXPECT_NE(option.name, "lr") << entry.name << ": the option is `rate` everywhere";
  }
  if (entry.needs_argument.empty())
    return;  // else it is not meant by "*", and says how it is named
  EXPECT_FALSE(entry.in_all) << entry.name;
  EXPECT_TRUE(entry.needs_argument.starts_with(entry.name + "[")) << entry.needs_argument;
}

TEST(Components, HaveATitleAFormulaASourceAndDocumentedOptions) {
  for (const auto& [name, entry] : catalog().problems) expect_described(entry);
  for (const auto& [name, entry] : catalog().optimizers) expect_described(entry);
}

TEST(Components, DefaultsAreWithinTheirOwnRanges) {
  for (const auto& [name, entry] : catalog().problems.ready())
    EXPECT_NO_THROW(complete_problem(catalog(), name, OptionValues())) << name;
  for (const auto& [name, entry] : catalog().optimizers.ready()) {
    const OptionValues defaults = complete_optimizer(catalog(), name, OptionValues()).options;
    EXPECT_NO_THROW(complete_optimizer(catalog(), name, defaults)) << name;
  }
}

// A component that vanishes is missed here.
const std::string kProblems =
    "scaling square exponential sine poisson heat rosenbrock powell-singular beale "
    "helical-valley brown-badly-scaled box3d wood brown-dennis broyden-tridiagonal "
    "variably-dimensioned hig-toy linear-chain coupled-oscillators quantum-dipole poisson-hig "
    "burgers wave-packet navier-stokes process";
const std::string kOptimizers =
    "gd momentum nesterov adagrad adadelta rmsprop adam adamw newton saddle-free-newton "
    "gauss-newton levenberg-marquardt inverse-gradient sip sip-theorem-3 sip-newton hig supervised "
    "two-stage rescaled "
    "adahessian hessian-free kfac ceres-gauss-newton ceres-lm ceres-dogleg "
    "ceres-subspace-dogleg ceres-bfgs ceres-lbfgs ceres-ncg ceres-steepest-descent "
    "nlopt-lbfgs nlopt-var2 nlopt-tnewton nlopt-slsqp nlopt-mma nlopt-ccsaq nlopt-bobyqa "
    "nlopt-cobyla nlopt-neldermead nlopt-sbplx levenberg-marquardt-cg process";

template <class Entries>
void expect_all_there(const std::string& names, const Entries& entries) {
  std::istringstream all(names);
  for (std::string name; all >> name;) EXPECT_TRUE(entries.contains(name)) << name;
}

TEST(Components, AllThatWereFoundedAreThere) {
  expect_all_there(kProblems, catalog().problems);
  expect_all_there(kOptimizers, catalog().optimizers);
}

TEST(Components, ANameRegisteredTwiceIsAnError) {
  Catalog twice = builtin_catalog();
  EXPECT_THROW(register_problems(twice.problems), UsageError);
  EXPECT_THROW(register_optimizers(twice.optimizers), UsageError);
}

// One type a name: what the linker would merge in silence (one definition rule), over the sources
// and over the symbols of the compiled objects.

using Set = std::set<std::string>;

struct Type {
  std::string name;  // isoline::reports::Point; of a nested one the outer alone is listed
  std::size_t line;
  bool is_anonymous;
  bool is_defined;  // or only declared
};

// Types at namespace scope, which clang-format puts at the beginning of a line.
std::vector<Type> types_of(const Source& source) {
  static const std::regex space(R"re(^(inline )?namespace ?([\w:]*) ?\{)re");
  static const std::string kind = "(?:struct|class|enum class|enum|union) (?:alignas\\([^)]*\\) )?";
  static const std::regex type("^(?:template <.*> )?" + kind +
                               R"re((\w+)( final)?( :.*| \{.*|;.*)?$)re");
  std::vector<std::string> spaces;
  std::vector<Type> types;
  for (std::size_t i = 0; i < source.lines.size(); ++i) {
    std::smatch match;
    const std::string& line = source.lines[i];
    if (std::regex_search(line, match, space)) {
      spaces.push_back(match[2]);
    } else if (line.starts_with("}  // namespace") && !spaces.empty()) {
      spaces.pop_back();
    } else if (std::regex_match(line, match, type)) {
      const std::string rest = without_comment(match[3].str());
      const bool is_declaration =
          rest.find(';') != std::string::npos && rest.find('{') == std::string::npos;
      std::string name;
      for (const std::string& each : spaces)
        if (!each.empty()) name += each + "::";
      const bool is_anonymous = std::ranges::find(spaces, "") != spaces.end();
      types.push_back({name + match[1].str(), i + 1, is_anonymous, !is_declaration});
    }
  }
  return types;
}

std::string list_of(const Set& names) {
  std::string text;
  for (const std::string& name : names) text += " " + name;
  return text;
}

// The files that define each type which other files can name, by its name. What tests define is in
// programs of their own.
std::map<std::string, Set> definitions() {
  std::map<std::string, Set> found;
  for (const Source& source : sources()) {
    if (source.is_test()) continue;
    for (const Type& type : types_of(source))
      if (type.is_defined && !type.is_anonymous) found[type.name].insert(source.path);
  }
  return found;
}

TEST(Types, HaveOneDefinitionANamespace) {
  const std::map<std::string, Set> all = definitions();
  EXPECT_GT(all.size(), 200U) << "the types were not found";
  for (const auto& [name, files] : all)
    EXPECT_EQ(files.size(), 1U) << name << ":" << list_of(files);
}

TEST(Types, OfASourceFileAreAnonymousUnlessAHeaderDeclaresThem) {
  Set declared;
  for (const Source& source : sources())
    for (const Type& type : types_of(source))
      if (source.is_header()) declared.insert(type.name);
  for (const Source& source : sources()) {
    if (source.is_header()) continue;
    for (const Type& type : types_of(source))
      EXPECT_TRUE(type.is_anonymous || declared.contains(type.name))
          << source.path << ":" << type.line << ": " << type.name
          << " can be named by other files and belongs in an anonymous namespace";
  }
}

// --- the compiled objects

struct Symbol {
  std::string object, name;
  bool is_shared;  // the linker keeps one of several and believes that they are equal
};

// What the objects of our libraries define for one another: the upper-case symbols of nm.
std::vector<Symbol> symbols() {
  static const std::regex pattern(R"re(^(\S.*\.o): ?[0-9a-f]* +([A-Z]) (.*)$)re");
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "symbols").string();
  EXPECT_EQ(std::system(("nm -AC --defined-only " ISOLINE_ARCHIVES " > " + file).c_str()), 0);
  std::vector<Symbol> found;
  std::ifstream lines(file);
  std::smatch match;
  for (std::string line; std::getline(lines, line);)
    if (line.find("isoline::") != std::string::npos && std::regex_match(line, match, pattern))
      found.push_back({match[1], match[3], match[2] == "W" || match[2] == "V"});
  return found;
}

// Our types that a symbol mentions, as owner, argument or argument of a template.
Set types_in(const std::string& symbol) {
  static const std::regex pattern(R"re(\bisoline::(?:[a-z_]\w*::)*[A-Z]\w*)re");
  Set found;
  for (std::sregex_iterator it(symbol.begin(), symbol.end(), pattern), end; it != end; ++it)
    found.insert(it->str());
  return found;
}

TEST(Symbols, NoFunctionIsDefinedInTwoObjects) {
  std::map<std::string, Set> objects;
  for (const Symbol& symbol : symbols())
    if (!symbol.is_shared) objects[symbol.name].insert(symbol.object);
  EXPECT_GT(objects.size(), 500U) << "the symbols were not found";
  for (const auto& [name, files] : objects)
    EXPECT_EQ(files.size(), 1U) << name << ":" << list_of(files);
}

// An inline member or an instantiation over a type stands in every object that uses it. Where two
// types have one name, the linker takes either.
TEST(Symbols, WhatObjectsShareIsAboutTypesThatAreDefinedOnce) {
  std::map<std::string, Set> objects;  // by type
  for (const Symbol& symbol : symbols())
    if (symbol.is_shared)
      for (const std::string& type : types_in(symbol.name)) objects[type].insert(symbol.object);
  const std::map<std::string, Set> defined = definitions();
  std::size_t count = 0;
  for (const auto& [type, files] : objects) {
    if (files.size() < 2 || type == "isoline::Parts") continue;  // which cmake/parts.h.in defines
    ++count;
    const auto at = defined.find(type);
    ASSERT_NE(at, defined.end()) << type << " is in" << list_of(files) << " and in no header";
    EXPECT_EQ(at->second.size(), 1U) << type << " is defined in" << list_of(at->second);
  }
  EXPECT_GT(count, 20U) << "the shared types were not found";
}

// The examples in the help of each verb are commands that the program reads.

// Words as a shell has them, as far as the examples go: single quotes, and no others. What follows
// two blanks or more tells what the command is for.
std::vector<std::string> example_words(const std::string& line) {
  static const std::regex word("(?:'[^']*'|[^ '])+");
  const std::string command = line.substr(0, std::min(line.find("  "), line.find(" > ")));
  std::vector<std::string> words;
  for (std::sregex_iterator it(command.begin(), command.end(), word), end; it != end; ++it)
    std::erase(words.emplace_back(it->str()), '\'');
  return words;
}

std::vector<std::string> examples_in(const std::string& help) {
  std::vector<std::string> examples;
  std::istringstream text(help);
  for (std::string line; std::getline(text, line);)
    if (line.starts_with("  isoline ")) examples.push_back(line.substr(2));
  return examples;
}

void expect_read(const std::string& example) {
  std::vector<std::string> words = example_words(example);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  EXPECT_EQ(
      refusal([&] { parse_only("isoline", static_cast<int>(arguments.size()), arguments.data()); }),
      "")
      << example;
}

TEST(Examples, InTheHelpOfEveryVerbAreRead) {
  const std::vector<Verb> verbs = all_verbs();
  EXPECT_GT(verbs.size(), 15U);
  for (const Verb& verb : verbs) {
    const std::vector<std::string> examples = examples_in(verb.examples);
    EXPECT_FALSE(examples.empty()) << verb.name;
    for (const std::string& example : examples) expect_read(example);
  }
  for (const std::string& example : examples_in(program_examples())) expect_read(example);
}

}  // namespace
}  // namespace isoline::benchmarks
