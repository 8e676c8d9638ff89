#!/usr/bin/env bash
# pagmo 2.18.0: xnes keeps a champion outside the box of its problem, below the least value inside.
#
# Guess before the run: a problem states its bounds itself (get_bounds), so every algorithm stays within them.
# Seen: on Rosenbrock's function with x1 <= 0.5, xnes evaluates most of 1,020 points outside, and its champion is 4e-9, where
# the least inside is 0.25. Its option force_bounds is false by default. de, sade, pso, gaco, bee_colony, sga, gwo, ihs,
# simulated_annealing and compass_search make no call outside. Pass force_bounds = true.
. "$(dirname "$0")/packages.sh"
debian libpagmo-dev=2.18.0-2+b1 libpagmo8=2.18.0-2+b1 libeigen3-dev=3.4.0-4
cat >"$work/run.cpp" <<'C'
#include <cstdio>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/algorithms/xnes.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>

static long calls, outside;
struct Valley {
  pagmo::vector_double fitness(const pagmo::vector_double &x) const {
    ++calls;
    outside += x[0] < -2 || x[0] > 0.5 || x[1] < -2 || x[1] > 2;
    const double a = x[1] - x[0] * x[0], b = 1 - x[0];
    return {100 * a * a + b * b};
  }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const { return {{-2, -2}, {0.5, 2}}; }
};
template <class Method>
void run(const char *name, Method method) {
  calls = outside = 0;
  pagmo::population all(pagmo::problem(Valley()), 20, 1U);
  all = pagmo::algorithm(method).evolve(all);
  std::printf("%s: %s outside, champion %s the least inside\n", name, 2 * outside > calls ? "most" : outside > 0 ? "some" : "none",
              all.champion_f()[0] < 0.2499 ? "below" : "not below");
}
int main() {
  run("de", pagmo::de(50U));
  run("xnes", pagmo::xnes(50U));
  run("xnes with force_bounds", pagmo::xnes(50U, -1, -1, -1, -1, 1e-6, 1e-6, false, true));
}
C
compile "$work/run.cpp" -std=c++17 -lpagmo -lboost_serialization -ltbb
expect 'de: none outside, champion not below the least inside
xnes: most outside, champion below the least inside
xnes with force_bounds: none outside, champion not below the least inside' "$work/program"
