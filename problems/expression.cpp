// Expressions by recursive descent: sum, product, power, atom.
#include "problems/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/errors.h"
#include "core/text.h"

namespace isoline::problems {
namespace {

using Value = Expression::Value;
using Node = std::function<Value(const Vector& x)>;

// f(g) and f' at g.
struct Function {
  const char* name;
  Real (*value)(Real);
  Real (*slope)(Real);
};
constexpr std::array<Function, 8> kFunctions = {{
    {"exp", [](Real g) { return std::exp(g); }, [](Real g) { return std::exp(g); }},
    {"log", [](Real g) { return std::log(g); }, [](Real g) { return 1 / g; }},
    {"log10", [](Real g) { return std::log10(g); },
     [](Real g) { return 1 / (g * std::log(10.0)); }},
    {"sqrt", [](Real g) { return std::sqrt(g); }, [](Real g) { return 0.5 / std::sqrt(g); }},
    {"sin", [](Real g) { return std::sin(g); }, [](Real g) { return std::cos(g); }},
    {"cos", [](Real g) { return std::cos(g); }, [](Real g) { return -std::sin(g); }},
    {"tan", [](Real g) { return std::tan(g); },
     [](Real g) { return 1 + std::tan(g) * std::tan(g); }},
    {"abs", [](Real g) { return std::abs(g); }, [](Real g) { return g < 0 ? -1.0 : 1.0; }},
}};

bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) || c == '_' || (c & 0x80);
}
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Each level, and each term of a sum, takes of the stack.
constexpr int kMostNesting = 200;
constexpr std::size_t kMostBytes = 4096, kMostQuoted = 60;

class Parser {
 public:
  Parser(std::string_view text, const std::vector<std::string>& names)
      : text_(text), names_(names) {}

  Node whole() {
    require(text_.size() <= kMostBytes, [&] {
      return fmt::format("the expression '{}…' has {} bytes; at most {} are allowed",
                         cut(text_, kMostQuoted), text_.size(), kMostBytes);
    });
    Node node = sum();
    if (at_ < text_.size()) refuse("an operator");
    return node;
  }

 private:
  char next() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (next() != c) return false;
    ++at_;
    return true;
  }
  [[noreturn]] void refuse(const char* expected) {
    next();
    throw UsageError(fmt::format("the expression '{}' must have {} at its character {}", text_,
                                 expected, at_ + 1));
  }

  Node sum() {
    Node a = product();
    while (next() == '+' || next() == '-') {
      const Real sign = text_[at_++] == '+' ? 1 : -1;
      a = [a, b = product(), sign](const Vector& x) {
        const Value g = a(x), h = b(x);
        return Value{g.value + sign * h.value, g.by + sign * h.by};
      };
    }
    return a;
  }
  Node product() {
    Node a = signed_power();
    while (next() == '*' || next() == '/') {
      const bool is_quotient = text_[at_++] == '/';
      a = [a, b = signed_power(), is_quotient](const Vector& x) {
        const Value g = a(x), h = b(x);
        if (!is_quotient) return Value{g.value * h.value, g.value * h.by + h.value * g.by};
        return Value{g.value / h.value, (g.by - g.value / h.value * h.by) / h.value};
      };
    }
    return a;
  }
  Node signed_power() {
    require(++depth_ <= kMostNesting, [&] {
      return fmt::format("the expression '{}…' is nested deeper than {} levels",
                         cut(text_, kMostQuoted), kMostNesting);
    });
    Node node = take('+') ? signed_power() : take('-') ? negative(signed_power()) : power();
    --depth_;
    return node;
  }
  static Node negative(Node a) {
    return [a = std::move(a)](const Vector& x) {
      const Value g = a(x);
      return Value{-g.value, -g.by};
    };
  }
  Node power() {
    Node a = atom();
    const bool is_power = take('^') || (text_.substr(at_).starts_with("**") && (at_ += 2));
    if (!is_power) return a;
    return [a, b = signed_power()](const Vector& x) {
      const Value g = a(x), h = b(x);
      const Real f = std::pow(g.value, h.value);
      Vector by = h.value * std::pow(g.value, h.value - 1) * g.by;
      if (!h.by.isZero(0)) by += f * std::log(g.value) * h.by;
      return Value{f, by};
    };
  }
  Node atom() {
    const char c = next();
    if (take('(')) return closed();
    if (is_digit(c) || c == '.') return number();
    if (!is_letter(c)) refuse("a number, a name or a parenthesis");
    const std::size_t begin = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    const std::string_view name = text_.substr(begin, at_ - begin);
    const auto named = std::ranges::find(names_, name);
    if (named != names_.end())
      return [i = static_cast<Index>(named - names_.begin())](const Vector& x) {
        return Value{x[i], Vector::Unit(x.size(), i)};
      };
    const auto* const function = std::ranges::find(kFunctions, name, &Function::name);
    std::string known;
    for (const std::string& each : names_)
      if (!each.empty()) known += " " + each;
    if (function == kFunctions.end() || !take('('))
      throw UsageError(fmt::format("'{}' in the expression '{}' is not known there; known are{}",
                                   name, text_, known));
    return [a = closed(), function](const Vector& x) {
      const Value g = a(x);
      return Value{function->value(g.value), function->slope(g.value) * g.by};
    };
  }
  Node closed() {
    Node node = sum();
    if (!take(')')) refuse("a closing parenthesis");
    return node;
  }
  Node number() {
    Real value = 0;
    const auto [end, error] =
        std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc()) refuse("a number");
    at_ = static_cast<std::size_t>(end - text_.data());
    return [value](const Vector& x) { return Value{value, Vector::Zero(x.size())}; };
  }

  std::string_view text_;
  const std::vector<std::string>& names_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

Expression::Expression(std::string_view text, const std::vector<std::string>& names)
    : evaluate_(Parser(text, names).whole()) {}

}  // namespace isoline::problems
