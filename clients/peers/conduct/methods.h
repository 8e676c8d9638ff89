// The lines between a library and conduct.py: the input on standard input, then a line for each
// call of the callback and its answer.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

using Vector = std::vector<double>;

inline struct {
  std::size_t n, m, limit;
  bool has_bounds;
  std::size_t runs;
  Vector x, lower, upper;
} given;

inline Vector read() {
  std::string line;
  std::getline(std::cin, line);
  std::istringstream words(line);
  Vector numbers;
  for (std::string word; words >> word;) numbers.push_back(std::strtod(word.c_str(), nullptr));
  return numbers;
}

inline Vector ask(const char* verb, const double* x) {
  std::printf("%s", verb);
  for (std::size_t i = 0; i < given.n; ++i) std::printf(" %.17g", x[i]);
  std::puts("");
  std::fflush(stdout);
  return read();
}

inline void finish(bool success, const std::string& own, const std::string& code, const double* x) {
  ask(("done " + std::to_string(success) + " " + own + " " + code).c_str(), x);
}

inline void begin() {
  const Vector begun = read();
  given = {std::size_t(begun[0]),
           std::size_t(begun[1]),
           std::size_t(begun[2]),
           begun[3] == 1,
           std::size_t(begun[4]),
           {},
           {},
           {}};
  const auto part = [&](std::size_t i) {
    return Vector(&begun[5 + i * given.n], &begun[5 + i * given.n] + given.n);
  };
  given.x = part(0), given.lower = part(1), given.upper = part(2);
}

// Those that are given, or so far that none binds, for methods that take finite bounds alone.
inline std::pair<Vector, Vector> finite_bounds() {
  Vector lower = given.lower, upper = given.upper;
  for (std::size_t i = 0; !given.has_bounds && i < given.n; ++i) {
    const double far = 1e3 * std::max(1.0, std::abs(given.x[i]));
    lower[i] = given.x[i] - far, upper[i] = given.x[i] + far;
  }
  return {lower, upper};
}

// Runs a method as often as asked, each time from the start.
template <class Method>
void run_each(const Method& method) {
  begin();
  const Vector start = given.x;
  for (std::size_t i = 0; i < given.runs; ++i) given.x = start, method();
}
