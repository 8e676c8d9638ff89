// What a learning run makes of its validation: one sample as N×N grids, or some small samples, one
// a column. Grids are stored beside the record, as an array (3, N, N) of y*, x and x* in `.npy`.
#pragma once

#include <string>

#include "core/grid.h"

namespace isoline {

struct Exhibit {
  Index grid = 0;         // N, or 0
  Grid target, x, truth;  // one sample a column; empty where they are read from the file beside

  bool is_picture() const { return grid > 0; }
};

void write_pictures(const Exhibit& exhibit, const std::string& path);
void read_pictures(Exhibit& exhibit, const std::string& path);

}  // namespace isoline
