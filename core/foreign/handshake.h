// What another program says of itself before anything is computed, as JSON, held to its law.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/aim.h"
#include "core/foreign/foreign.h"
#include "core/foreign/line.h"
#include "core/oracle.h"

namespace isoline {

// What every program says: of Foreign its label, interpreter, packages, note and source.
struct ProblemHandshake {
  Foreign foreign;
  std::int64_t inputs = 0, outputs = 0;  // k, m
  OracleSet oracles;                     // forward, and of the others what it has
  std::int64_t pushforward_price = 1, pullback_price = 1, inverse_price = 1;
  bool are_differences = false;     // its products are quotients of forwards
  std::string inverse;              // "exact", "damped", "estimate", "approximate"; empty: none
  std::vector<Real> start, target;  // θ₀ of seed 0 (k), y* (m)
  std::vector<Real> drawn;          // θ₀ of the seed that it was told, where it draws its own
  std::vector<Real> truth;          // x*, where it knows it
  std::vector<Real> lower, upper;   // bounds on x (k), where it has any
  std::optional<Real> minimum;      // f_L, likewise
  Aim aim = Aim::loss;
};

struct MethodHandshake {
  Foreign foreign;
  OracleSet needs;                // that it will ask
  bool is_least_squares = false;  // it descends ½‖r‖², whatever the loss
  bool reports = false;           // its iterations; else each new best point counts as one
};

// From the text that `who` answered with. UsageError, which quotes it, where it breaks the law.
ProblemHandshake problem_handshake(const std::string& text, const std::string& who);
MethodHandshake method_handshake(const std::string& text, const std::string& who);

// Greets whoever was just started, who has so many seconds to answer. UsageError where it does not,
// or says what it must not.
ProblemHandshake greet_problem(Line& line, std::uint64_t seed, double seconds);
MethodHandshake greet_method(Line& line, double seconds);

}  // namespace isoline
