// One type a name: what the linker would merge in silence (one definition rule), over the sources
// and over the symbols of the compiled objects.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/structure/sources.h"
#include "tests/temporary_folder.h"

namespace isoline {
namespace {

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
    if (files.size() < 2) continue;
    ++count;
    const auto at = defined.find(type);
    ASSERT_NE(at, defined.end()) << type << " is in" << list_of(files) << " and in no header";
    EXPECT_EQ(at->second.size(), 1U) << type << " is defined in" << list_of(at->second);
  }
  EXPECT_GT(count, 20U) << "the shared types were not found";
}

}  // namespace
}  // namespace isoline
