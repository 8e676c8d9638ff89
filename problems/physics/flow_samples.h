// The flows that are sought, and the marker that shows them: Holl, Koltun, Thuerey (2022),
// published scripts of the fluid experiment, on a square of 128 by 128.
#pragma once

#include "core/array.h"
#include "core/random.h"

namespace isoline::problems {

struct FlowSample {
  Vector velocity;  // (2N²) at the centres of the cells, x and then y
  Vector marker;    // (N²) 0 or 1
  Real strength;    // of the vortex
};

// A marker of an unusual shape within a box of 56 around a centre from U[32, 96]², a translation
// that brings it to the middle of the domain within `time`, a vortex there of strength U[−2, 2],
// and fluctuations of 0.1. The marker fills a share from U[0.05, 0.15] of all cells, drawn for each
// sample; the scripts draw it for each batch.
FlowSample draw_flow(Index N, Real time, RandomStream& stream);

// ω ẑ × r e^(−r²/800) around the middle, added to a velocity at the centres.
void add_vortex(Index N, Real strength, VectorOut velocity);
// Of a velocity at the centres, as the scripts have it: mean (rₓ v_y − r_y vₓ) / 120.5, of a vortex
// of strength 1 on 64×64 cells 1.0002.
Real vortex_strength(Index N, VectorRef velocity);

// Σ m p / Σ m over the cells at p, without regard to periods, as published. Not finite where Σ m
// is 0.
Eigen::Vector2d centre_of_mass(Index N, VectorRef marker);

constexpr Real kFlowLength = 128;  // of the domain's side
constexpr Real kFlowMiddle = 64;

}  // namespace isoline::problems
