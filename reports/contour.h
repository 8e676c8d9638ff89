// Isolines of a landscape by marching squares. Lorensen, Cline (1987), in two dimensions.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/sheet.h"

namespace isoline {

struct Point {
  Real x1 = 0, x2 = 0;
};
using Polyline = std::vector<Point>;  // closed where its ends agree

struct Contour {
  Real level = 0;
  std::vector<Polyline> lines;
};

// Linear between grid points. A cell with a corner that is not finite is left out.
std::vector<Polyline> isolines(const Landscape& landscape, Real level);

// Levels that show the problem as its source does: square, 2^i for i = −5 … 7 (Holl et al. 2022,
// Fig. 1); sine, even steps of L^0.2 (Fig. 5a); all others, even steps of log L.
std::vector<Real> contour_levels(const std::string& problem, const Landscape& landscape);

std::string contour_wording(const std::string& problem);  // "at 2^i, i = −5 … 7"

// What a plot shows: the landscape's own window, or the axes of the published figure.
std::array<Real, 4> view_window(const std::string& problem, const Landscape& landscape,
                                bool is_in_y);

std::vector<Contour> contours(const std::string& problem, const Landscape& landscape);

}  // namespace isoline
