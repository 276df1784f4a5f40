// products.hpp - kernels of vectors and sparse matrices of blocks.
#pragma once

#include "core/base/math.hpp"
#include "core/base/parallel.hpp"

namespace cdem {

/// What a product does with the vector that it writes.
enum class Into { replace, add, take_from };

/// Row of y = A x, y += A x, or y = b - A x.
template <Index height, Index width, Into into>
struct MultiplyRow {
  const Index *first, *column;
  const Real *block, *x, *b;
  Real* y;

  CDEM_HD void operator()(One row) const {
    Real sum[height] = {};
    for (Index e = first[row.i]; e < first[row.i + 1]; ++e) {
      const Real* a = block + std::size_t(e) * (height * width);
      const Real* u = x + std::size_t(column[e]) * width;
      for (Index i = 0; i < height; ++i)
        for (Index j = 0; j < width; ++j) sum[i] += a[i * width + j] * u[j];
    }
    Real* out = y + std::size_t(row.i) * height;
    for (Index i = 0; i < height; ++i) {
      if constexpr (into == Into::take_from)
        out[i] = b[std::size_t(row.i) * height + i] - sum[i];
      else
        out[i] = into == Into::add ? out[i] + sum[i] : sum[i];
    }
  }
};

/// x += weight B^-1 r in a group of consecutive rows, whose dense inverse is known.
struct SmoothGroup {
  const Index* first;             // [group + 1] numbers of the vector
  const std::size_t* inverse_of;  // [group + 1] where its matrix begins
  const Real *inverse, *r;
  Real weight;
  Real* x;

  CDEM_HD void operator()(One group) const {
    const Index begin = first[group.i], n = first[group.i + 1] - begin;
    const Real* a = inverse + inverse_of[group.i];
    for (Index i = 0; i < n; ++i) {
      Real sum = 0;
      for (Index j = 0; j < n; ++j) sum += a[std::size_t(i) * n + j] * r[begin + j];
      x[begin + i] += weight * sum;
    }
  }
};

/// Product of two vectors, three numbers at a time.
struct DotOfThree {
  const Real *a, *b;

  CDEM_HD Real operator()(One item) const {
    const Real *u = a + std::size_t(item.i) * 3, *v = b + std::size_t(item.i) * 3;
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  }
};

/// y = a x + b y
struct Combine {
  Real a, b;
  const Real* x;
  Real* y;

  CDEM_HD void operator()(One item) const { y[item.i] = a * x[item.i] + b * y[item.i]; }
};

}  // namespace cdem
