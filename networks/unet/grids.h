// What a U-net does on one N×N grid of pixels besides convolving: halos, pooling, upsampling, and
// their transposes. A grid is [column][row], and lies within a halo of one where `halo` says so.
#pragma once

#include <algorithm>
#include <array>

#include "networks/lanes.h"

namespace isoline::networks {

struct Grid {
  Index N, halo = 0;

  Index width() const { return N + 2 * halo; }
  Index pixels() const { return width() * width(); }
  Index at(Index column, Index row) const { return (column + halo) * width() + row + halo; }
};

// Rows first, then whole columns: the corners come along.
template <class Element>
void fill_halo(Element* image, Index N, bool is_circular) {
  const Index width = N + 2;
  const auto copy = [&](Index to, Index from, Index count) {
    if (is_circular)
      std::copy_n(image + from, count, image + to);
    else
      std::fill_n(image + to, count, Element{});
  };
  for (Index column = 1; column <= N; ++column) {
    copy(column * width, column * width + N, 1);
    copy(column * width + N + 1, column * width + 1, 1);
  }
  copy(0, N * width, width);
  copy((N + 1) * width, width, width);
}

// relu(scale z + shift): the pixels of z after batch norm and rectifier.
template <class T>
struct Activated {
  Place z;
  T scale, shift;

  T normalized(Index pixel) const { return scale * load<T>(z, pixel) + shift; }
  T operator()(Index pixel) const {
    const T y = normalized(pixel);
    return keep(is_positive(y), y);
  }
};

template <class T>
void activate(const Activated<T>& a, const Place& out, const Grid& grid) {
  for (Index column = 0; column < grid.N; ++column)
    for (Index row = 0; row < grid.N; ++row)
      store(out, grid.at(column, row), a(column * grid.N + row));
}

// The four pixels of a grid twice as fine.
inline std::array<Index, 4> finer(Index N, Index column, Index row) {
  const Index first = 2 * column * 2 * N + 2 * row, next = first + 2 * N;
  return {first, first + 1, next, next + 1};
}

// The largest of each four; of equals the first.
template <class T>
void pool(const Activated<T>& a, const Place& out, const Grid& grid) {
  for (Index column = 0; column < grid.N; ++column)
    for (Index row = 0; row < grid.N; ++row) {
      const auto four = finer(grid.N, column, row);
      T best = a(four[0]);
      for (int k = 1; k < 4; ++k) {
        const T x = a(four[k]);
        best = choose(value_of(x) > value_of(best), x, best);
      }
      store(out, grid.at(column, row), best);
    }
}

// The transpose of pool: fine pixel ← coarse cotangent where it was the largest, else 0.
template <class T>
void unpool(const Activated<T>& a, const Place& coarse, const Place& fine, Index N) {
  for (Index column = 0; column < N; ++column)
    for (Index row = 0; row < N; ++row) {
      const auto four = finer(N, column, row);
      Lane y[4], best = {};
      for (int k = 0; k < 4; ++k) {
        y[k] = value_of(a(four[k]));
        best = choose(y[k] > best, y[k], best);
      }
      const T cotangent = load<T>(coarse, column * N + row);
      Mask is_free = best == best;
      for (int k = 0; k < 4; ++k) {
        const Mask is_largest = is_free & (y[k] == best);
        store(fine, four[k], keep(is_largest, cotangent));
        is_free &= ~is_largest;
      }
    }
}

// Twice as fine, bilinear between pixel centres (align_corners = false), clamped at the border:
// ¾ of the nearest and ¼ of the next. `grid` is the fine one.
template <class T>
void upsample(const Place& coarse, const Place& out, const Grid& grid) {
  const Index N = grid.N / 2;
  const auto next = [N](Index i) {
    return std::clamp(i % 2 ? i / 2 + 1 : i / 2 - 1, Index{0}, N - 1);
  };
  for (Index column = 0; column < grid.N; ++column) {
    const Place near = coarse + column / 2 * N, far = coarse + next(column) * N;
    for (Index row = 0; row < grid.N; ++row) {
      const T close = 0.75F * load<T>(near, row / 2) + 0.25F * load<T>(near, next(row));
      const T distant = 0.75F * load<T>(far, row / 2) + 0.25F * load<T>(far, next(row));
      store(out, grid.at(column, row), 0.75F * close + 0.25F * distant);
    }
  }
}

// The transpose of upsample, from 2N×2N to N×N: each coarse pixel gathers from four fine columns
// and rows; beyond the border stands the border itself.
template <class T>
void downsample(const Place& fine, const Place& coarse, Index N) {
  constexpr float kWeights[4] = {0.25F, 0.75F, 0.75F, 0.25F};
  const auto clamped = [N](Index i) { return std::clamp(i, Index{0}, 2 * N - 1); };
  for (Index column = 0; column < N; ++column)
    for (Index row = 0; row < N; ++row) {
      T sum{};
      for (Index i = 0; i < 4; ++i) {
        const Place from = fine + clamped(2 * column - 1 + i) * 2 * N;
        T along{};
        for (Index j = 0; j < 4; ++j)
          along = along + kWeights[j] * load<T>(from, clamped(2 * row - 1 + j));
        sum = sum + kWeights[i] * along;
      }
      store(coarse, column * N + row, sum);
    }
}

}  // namespace isoline::networks
