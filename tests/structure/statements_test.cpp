// The rules of style about single statements: no comma between two, no view behind auto.
#include <gtest/gtest.h>

#include <regex>

#include "tests/structure/code.h"

namespace isoline {
namespace {

// What follows the labels and conditions that a statement begins with.
std::string without_conditions(std::string text) {
  static const std::regex label(
      R"re(^(else|do)\b ?|^(case [^:]*|default|public|private|protected): ?)re");
  static const std::regex condition(R"re(^(if constexpr|if|for|while|switch) ?\()re");
  for (std::smatch match; true;) {
    if (std::regex_search(text, match, label)) {
      text = text.substr(std::size_t(match.length()));
    } else if (std::regex_search(text, match, condition)) {
      std::size_t at = text.find('('), depth = 0;
      for (; at < text.size(); ++at) {
        depth += text[at] == '(';
        if (text[at] == ')' && --depth == 0) break;
      }
      if (at == text.size()) return text;
      text = text.substr(text.find_first_not_of(' ', at + 1) == std::string::npos
                             ? text.size()
                             : text.find_first_not_of(' ', at + 1));
    } else {
      return text;
    }
  }
}

std::string without_template_arguments(std::string text) {
  static const std::regex arguments(R"re((\w)<[^<>;=()]*>)re");
  for (std::string before; before != text;) {
    before = text;
    text = std::regex_replace(text, arguments, "$1");
  }
  return text;
}

// What stands before the first comma outside of brackets; nothing where there is none.
std::string before_comma(const std::string& text) {
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    depth += text[i] == '(' || text[i] == '[';
    depth -= text[i] == ')' || text[i] == ']';
    if (text[i] == ',' && depth == 0) return text.substr(0, i);
  }
  return "";
}

// "a = 1, b = 2", "f(), g()" and "return a, b" are; a declaration has a blank between type and
// name, and Eigen's "v << a, b" is its way to fill an array.
bool is_comma_statement(const std::string& statement) {
  static const std::regex assignment(R"re(^[\w.:>\-\[\]*()+]+ ?([-+*/%|&^]|<<|>>)?=[^=].*)re");
  static const std::regex call(R"re(^[\w.:>\-]+\(.*\)$)re");
  static const std::regex count(R"re(^(\+\+|--).*|^\S+(\+\+|--)$)re");
  const std::string first = before_comma(without_template_arguments(without_conditions(statement)));
  if (std::regex_match(first, call)) return first.find(") << ") == std::string::npos;
  return std::regex_match(first, assignment) || std::regex_match(first, count) ||
         first.starts_with("return ");
}

TEST(Statements, SayOneThing) {
  for (const char* two : {"a = 1, b = 2", "if (x) a += f<int, 2>(x), ++n", "f(), g(1, 2)",
                          "return f(), true", "else ++i, ++j", "x[0] = y, z[1] = 2"})
    EXPECT_TRUE(is_comma_statement(two)) << two;
  for (const char* one : {"int a = 1, b = 2", "a = std::map<int, int>()", "v << 1, 2", "f(a, b)",
                          "v.col(0) << f(1), 2", "for (int i = 0, j = 1", "return {}",
                          "using A = std::map<int, int>", "const auto [a, b] = f()"})
    EXPECT_FALSE(is_comma_statement(one)) << one;
  std::size_t statements = 0;
  for (const Source& source : sources())
    for (const Statement& statement : statements_of(code_of(source.text))) {
      ++statements;
      EXPECT_FALSE(is_comma_statement(statement.text))
          << source.path << ":" << statement.line << ": " << statement.text;
    }
  EXPECT_GT(statements, 5000U) << "the statements were not found";
}

// A view of an array that dies or changes before the view is read: write the type.
TEST(Statements, LetAutoHoldNoExpressionOfEigen) {
  static const std::string views =
      "array|matrix|col|row|block|segment|head|tail|transpose|cwise\\w+|colwise|rowwise|reshaped|"
      "diagonal|(left|right|middle)Cols|(top|bottom|middle)Rows|replicate|asDiagonal|noalias|"
      "unaryExpr|binaryExpr|triangularView|selfadjointView";
  static const std::string numbers =
      "eval|size|rows|cols|sum|norm|squaredNorm|dot|maxCoeff|minCoeff|mean|prod|any|all|count|"
      "allFinite|hasNaN|data|value";
  static const std::regex expression(R"re(\bauto&{0,2} \w+ = [^;\[]*\.()re" + views +
                                     R"re()(<\w+>)?\()re");
  static const std::regex number(R"re(\.()re" + numbers + R"re()(<[\w:]+>)?\([^()]*\)$)re");
  for (const Source& source : sources())
    for (const Statement& statement : statements_of(code_of(source.text))) {
      if (!std::regex_search(statement.text, expression)) continue;
      EXPECT_TRUE(std::regex_search(statement.text, number))
          << source.path << ":" << statement.line << ": " << statement.text;
    }
}

}  // namespace
}  // namespace isoline
