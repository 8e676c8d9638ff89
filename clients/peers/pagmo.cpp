// A method of pagmo, within bounds that it needs: cmaes or de.
// flags: -I/usr/include/eigen3 -lpagmo -ltbb -lboost_serialization
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/population.hpp>

#include "peer.h"

Peer* peer;  // pagmo copies its problem

struct Loss {
  std::vector<double> fitness(const std::vector<double>& x) const {
    return {peer->value(x.data())};
  }
  std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    std::vector<double> lower = peer->lower, upper = peer->upper;
    constexpr double kFar = 10;
    for (std::size_t i = 0; i < lower.size(); ++i) {
      lower[i] = std::max(lower[i], peer->x0[i] - kFar);
      upper[i] = std::min(upper[i], peer->x0[i] + kFar);
    }
    return {lower, upper};
  }
};

int main(int, char** words) {
  const std::string method = words[1];
  Peer p({.name = "pagmo-" + method, .keeps_bounds = true});
  peer = &p;
  constexpr unsigned kGenerations = 10000, kSize = 20, kSeed = 1;
  pagmo::population all(Loss(), kSize - 1, kSeed);
  all.push_back(p.x0);
  all = method == "de"
            ? pagmo::de(kGenerations, 0.8, 0.9, 2, 1e-6, 1e-6, kSeed).evolve(all)
            : pagmo::cmaes(kGenerations, -1, -1, -1, -1, 0.5, 1e-6, 1e-6, false, true, kSeed)
                  .evolve(all);
  p.finish(all.champion_x().data(), "returned");
}
