// How cotangents travel between a U-net's convolutions: from the input of a unit to what it was
// assembled from, through rectifier and batch norm. With dual numbers their tangents come along.
#pragma once

#include "networks/unet/passes.h"

namespace isoline::networks {

// Sums over one task of g and g x̂, and of their tangents.
template <class T>
struct NormSums {
  T row{}, row_x{};

  void add(const T& g, const T& x) {
    row = row + g;
    row_x = row_x + g * x;
  }
  void flush(const UnitPass& pass, Index task, Index block) {
    accumulate(value_of(row), pass.sum(task, block, 0));
    accumulate(value_of(row_x), pass.sum(task, block, 1));
    if constexpr (kIsDual<T>) {
      accumulate(row.tangent, pass.sum(task, block, 2));
      accumulate(row_x.tangent, pass.sum(task, block, 3));
    }
    row = row_x = T{};
  }
};

enum class Part { only, first, last };  // of the cotangents of an activation that is used twice

// Takes the cotangent of one block of an activation through the rectifier.
template <class T>
void absorb(const UnitPass& pass, Index task, Index unit, Index sample, Index block,
            const Place& cotangent, Part part) {
  const auto a = activated<T>(pass.plan, pass.state, unit, sample, block);
  Norm& norm = pass.state.units[unit].norm;
  const T inverse = norm.at<T>(Norm::inverse, block), centre = norm.at<T>(Norm::centre, block);
  const Index level = pass.plan.units[unit].level, N = pass.plan.size(level);
  const Place g = pass.state.cotangents[level].place() + (sample * pass.blocks + block) * N * N;
  NormSums<T> sums;
  for (Index row = 0; row < N; ++row) {
    for (Index pixel = row * N; pixel < (row + 1) * N; ++pixel) {
      T x = load<T>(cotangent, pixel);
      if (part == Part::last) x = x + load<T>(g, pixel);
      const T z = load<T>(a.z, pixel);
      const T kept = keep(is_positive(a.scale * z + a.shift), x);
      store(g, pixel, kept);
      sums.add(kept, inverse * z + centre);
    }
    if (part != Part::first) sums.flush(pass, task, block);
  }
}

// The cotangent of z, through the batch norm.
template <class T>
Place norm_cotangent(const UnitPass& pass, Index task, Index halo, ThreadState& thread) {
  const Index N = pass.N;
  const Grid grid{N, halo};
  for (Index i = 0; i < pass.images * pass.blocks; ++i) {
    const Index block = i % pass.blocks;
    const Index before = task * pass.images * pass.blocks + i;
    const Place g = pass.state.cotangents[pass.unit.level].place() + before * N * N;
    const Place z = pass.own.z.place() + before * N * N;
    const Place out = thread.cotangent_z.place() + i * grid.pixels();
    Norm& norm = pass.own.norm;
    const T scale = norm.at<T>(Norm::scale, block), slope = norm.at<T>(Norm::slope, block);
    const T offset = norm.at<T>(Norm::offset, block);
    for (Index column = 0; column < N; ++column)
      for (Index row = 0; row < N; ++row) {
        const Index pixel = column * N + row;
        store(out, grid.at(column, row),
              scale * load<T>(g, pixel) + slope * load<T>(z, pixel) + offset);
      }
    fill_halos(out, grid, pass.plan.is_circular, kIsDual<T>);
  }
  return thread.cotangent_z.place();
}

// From the cotangent of a unit's input to those of the activations it was assembled from.
template <class T>
void scatter(const UnitPass& pass, Index task, ThreadState& thread) {
  const Unit& unit = pass.unit;
  const Index N = pass.N, count = pass.blocks_in();
  const Place spare = thread.spare.place();
  for (Index i = 0; i < pass.images * count; ++i) {
    const Index sample = task * pass.images + i / count, block = i % count;
    const Place in = thread.cotangent_in.place() + i * N * N;
    if (unit.source == Unit::Source::activation) {
      absorb<T>(pass, task, unit.from, sample, block, in, Part::only);
    } else if (unit.source == Unit::Source::pooled) {
      unpool(activated<T>(pass.plan, pass.state, unit.from, sample, block), in, spare, N);
      absorb<T>(pass, task, unit.from, sample, block, spare, Part::last);
    } else if (block < pass.blocks) {
      absorb<T>(pass, task, unit.skip, sample, block, in, Part::first);
    } else {
      downsample<T>(in, spare, N / 2);
      absorb<T>(pass, task, unit.from, sample, block - pass.blocks, spare, Part::only);
    }
  }
}

}  // namespace isoline::networks
