// Isolines of a landscape by marching squares. Lorensen, Cline (1987), in two dimensions.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/records/sheet.h"

namespace isoline::reports {

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

// Levels spaced as the landscape asks: 2^i for i = −5 … 7, or even steps of L^0.2 or of log L.
std::vector<Real> contour_levels(const Landscape& landscape);

std::string contour_wording(const Landscape& landscape);  // "at 2^i, i = −5 … 7"

std::vector<Contour> contours(const Landscape& landscape);

}  // namespace isoline::reports
