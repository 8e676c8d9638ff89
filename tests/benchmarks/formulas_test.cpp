// Every formula of the registries is typeset whole: well-formed, and no letter lost.
#include <gtest/gtest.h>

#include "benchmarks/plan/catalog.h"
#include "reports/html/mathml.h"
#include "reports/html/mathml_letters.h"

namespace isoline::benchmarks {

using reports::accent;
using reports::letters_of;
using reports::lowered;
using reports::mathml;
using reports::raised;
using reports::utf8_of;
namespace {

std::vector<std::string> formulas() {
  const Catalog catalog = builtin_catalog();
  std::vector<std::string> all;
  for (const auto& [name, entry] : catalog.problems) all.push_back(entry.formula);
  for (const auto& [name, entry] : catalog.optimizers) all.push_back(entry.formula);
  return all;
}

// The text between tags, entities resolved.
std::string text_of(const std::string& html) {
  std::string text;
  for (std::size_t i = 0; i < html.size(); ++i) {
    if (html[i] == '<') {
      i = html.find('>', i);
      continue;
    }
    if (html[i] != '&') {
      text += html[i];
      continue;
    }
    const std::size_t end = html.find(';', i);
    const std::string entity = html.substr(i + 1, end - i - 1);
    text += entity == "lt" ? "<" : entity == "gt" ? ">" : entity == "#39" ? "'" : "";
    i = end;
  }
  return text;
}

// What is left of a text when layout says what letters said: scripts are plain, blanks, fraction
// bars, roots and the parentheses around parts of fractions are gone.
std::u32string plain(const std::string& text) {
  std::u32string out;
  for (const char32_t letter : letters_of(text)) {
    if (std::u32string_view(U" /()^_√ ").find(letter) != std::u32string::npos) continue;
    if (letter == U'½')
      out += U"12";
    else if (letter == U'′')
      out += U'\'';
    else if (raised(letter) != 0)
      out += raised(letter);
    else if (lowered(letter) != 0)
      out += lowered(letter);
    else if (accent(letter) != 0 && accent(letter) != U'^')  // a hat is a caret in either text
      out += accent(letter);
    else if (accent(letter) == 0)
      out += letter;
  }
  return out;
}

// Opened tags in order; false where one is closed that is not the last opened.
bool is_well_formed(const std::string& html) {
  std::vector<std::string> open;
  for (std::size_t i = html.find('<'); i != std::string::npos; i = html.find('<', i + 1)) {
    const std::size_t end = html.find('>', i);
    if (end == std::string::npos) return false;
    const std::string tag = html.substr(i + 1, html.find_first_of(" >", i) - i - 1);
    if (tag[0] != '/')
      open.push_back(tag);
    else if (open.empty() || "/" + open.back() != tag)
      return false;
    else
      open.pop_back();
  }
  return open.empty();
}

TEST(Formulas, AreWellFormedAndLoseNoLetter) {
  const std::vector<std::string> all = formulas();
  EXPECT_GE(all.size(), 50U);
  for (const std::string& formula : all) {
    const std::string html = mathml(formula);
    EXPECT_TRUE(is_well_formed(html)) << formula << "\n" << html;
    EXPECT_EQ(utf8_of(plain(text_of(html))), utf8_of(plain(formula))) << html;
  }
}

// Where a formula has a caret, an underscore, a root or a half, layout must stand in its place.
TEST(Formulas, LeaveNoMarkOfPlainText) {
  for (const std::string& formula : formulas()) {
    const std::string text = text_of(mathml(formula));
    for (const char* mark : {"_", "√", "½", "²", "₁", "ᵢ", "ᵀ", "⁻"})
      EXPECT_EQ(text.find(mark), std::string::npos) << mark << " in " << formula;
  }
}

}  // namespace
}  // namespace isoline::benchmarks
