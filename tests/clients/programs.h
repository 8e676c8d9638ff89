// Commands of programs that are started by a door: those of this folder and the examples of
// clients/.
#pragma once

#include <cstdlib>
#include <string>

#include "core/spec.h"
#include "problems/problem.h"

namespace isoline {

// An interpreter that has a package; empty where none has it.
inline std::string python_with(const std::string& package) {
  for (const std::string python : {"python3", "/usr/bin/python3"}) {
    const std::string asked = python + " -c 'import " + package + "' >/dev/null 2>&1";
    if (std::system(asked.c_str()) == 0) return python;
  }
  return "";
}

inline std::string misbehaving(const std::string& words) {
  return "python3 " ISOLINE_SOURCE_DIR "/tests/clients/" + words;
}

inline std::string example(const std::string& words, const std::string& python = "python3") {
  return python + " " ISOLINE_SOURCE_DIR "/clients/python/examples/" + words;
}

// process[command="…"]
inline std::string process_of(const std::string& command, const std::string& more = "") {
  return "process[command=" + quoted(command) + more + "]";
}

// Rosenbrock's valley in the arithmetic of this build: whether the compiler fuses x₂ − x₁² into one
// rounding is its own choice.
inline std::string valley_of_this_build() {
  const problems::Problem ours = [] {
    problems::ProblemRegistry all("problem");
    problems::register_problems(all);
    return all.at("rosenbrock").make({}, problems::Draw(0, "rosenbrock"));
  }();
  problems::Point at;
  const Real x = 0.1;  // whose square is no double
  ours.forward(Eigen::Vector2d(x, x * x), at);
  return process_of(misbehaving(at.y(0) == 0 ? "valley.py plain" : "valley.py fused"));
}

}  // namespace isoline
