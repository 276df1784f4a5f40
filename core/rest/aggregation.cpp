// aggregation.cpp - see aggregation.hpp.
#include "core/rest/aggregation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace cdem {

RigidModes rigid_modes(const std::vector<Vec3<Real>>& place, const std::vector<Flag>& free) {
  Vec3<Real> middle{0, 0, 0};
  for (const Vec3<Real>& x : place) middle = middle + x;
  middle = (1.0 / Real(std::max<std::size_t>(place.size(), 1))) * middle;
  RigidModes modes(18 * place.size());
  for (std::size_t i = 0; i < place.size(); ++i) {
    const Vec3<Real> x = place[i] - middle;
    const Real rows[18] = {1, 0, 0, 0, x.z, -x.y, 0, 1, 0, -x.z, 0, x.x, 0, 0, 1, x.y, -x.x, 0};
    for (Index axis = 0; axis < 3; ++axis)
      for (Index k = 0; k < 6 && free[3 * i + axis]; ++k)
        modes[18 * i + 6 * axis + k] = rows[6 * axis + k];
  }
  return modes;
}

void invert(Index n, Real* a) {
  // Cholesky factor L, its inverse, and L^-T L^-1; all loops run along rows
  std::vector<Real> l(a, a + std::size_t(n) * n), inverse(l.size()), column(n);
  const auto row = [n](auto& of, Index i) { return &of[std::size_t(i) * n]; };
  constexpr Real tiny = 1e-13;
  for (Index j = 0; j < n; ++j) {
    const Real pivot = row(l, j)[j];
    const bool counts = pivot > tiny * a[std::size_t(j) * n + j];
    const Real root = counts ? std::sqrt(pivot) : 0;
    for (Index i = j + 1; i < n; ++i) column[i] = counts ? row(l, i)[j] / root : 0;
    row(l, j)[j] = root;
    for (Index i = j + 1; i < n; ++i) {
      Real* of = row(l, i);
      const Real own = of[j] = column[i];
      for (Index k = j + 1; k <= i; ++k) of[k] -= own * column[k];
    }
  }
  for (Index i = 0; i < n; ++i) {
    Real* of = row(inverse, i);
    const Real* factor = row(l, i);
    if (factor[i] == 0) continue;
    for (Index k = 0; k < i; ++k) {
      const Real* before = row(inverse, k);
      for (Index j = 0; j <= k; ++j) of[j] -= factor[k] * before[j];
    }
    for (Index j = 0; j < i; ++j) of[j] /= factor[i];
    of[i] = 1 / factor[i];
  }
  std::fill_n(a, l.size(), 0.0);
  for (Index k = 0; k < n; ++k) {
    const Real* of = row(inverse, k);
    for (Index i = 0; i <= k; ++i)
      for (Index j = 0; j <= k; ++j) a[std::size_t(i) * n + j] += of[i] * of[j];
  }
}

std::vector<Real> diagonal_inverses(const BlockRows& a) {
  const auto first = on_host(a.first), column = on_host(a.column);
  const auto block = on_host(a.block);
  const std::size_t size = a.block_size_of();
  std::vector<Real> inverse(a.rows() * size);
  for (Index r = 0; r < a.rows(); ++r)
    for (Index e = first[r]; e < first[r + 1]; ++e)
      if (column[e] == r) {
        std::copy_n(&block[e * size], size, &inverse[r * size]);
        invert(a.height, &inverse[r * size]);
      }
  return inverse;
}

Real largest_eigenvalue(const BlockRows& a, const std::vector<Real>& inverse) {
  const Index width = a.height, numbers = a.rows() * width;
  Column<Real> x, y;
  x.resize(numbers);
  y.resize(numbers);
  const auto start = on_host(x);
  for (Index i = 0; i < numbers; ++i)  // has a part of every mode
    start[i] = (i % 2 ? -1.0 : 1.0) * (1 + Real(i * std::int64_t(7919) % 101) / 101);
  Real largest = 0;
  for (int turn = 0; turn < 12; ++turn) {
    multiply({}, a, x.data(), y.data());
    const auto at_x = on_host(x), at_y = on_host(y);
    Real square = 0, before = 0;
    for (Index i = 0; i < numbers; ++i) before += at_x[i] * at_x[i];
    for (Index r = 0; r < a.rows(); ++r)
      for (Index i = 0; i < width; ++i) {
        Real sum = 0;
        for (Index j = 0; j < width; ++j)
          sum += inverse[(std::size_t(r) * width + i) * width + j] * at_y[r * width + j];
        at_x[r * width + i] = sum;
        square += sum * sum;
      }
    if (!(square > 0)) return 1;
    largest = std::sqrt(square / before);
    for (Index i = 0; i < numbers; ++i) at_x[i] /= std::sqrt(square);
  }
  return 1.1 * largest;
}

namespace {

/// Which rows couple to which.
std::vector<std::vector<Index>> couplings(const BlockRows& a, Real threshold) {
  const auto first = on_host(a.first), column = on_host(a.column);
  const auto block = on_host(a.block);
  const std::size_t size = a.block_size_of();
  const auto norm_of = [&](Index e) {
    Real sum = 0;
    for (std::size_t k = 0; k < size; ++k) sum += block[e * size + k] * block[e * size + k];
    return std::sqrt(sum);
  };
  std::vector<Real> diagonal(a.rows());
  for (Index r = 0; r < a.rows(); ++r)
    for (Index e = first[r]; e < first[r + 1]; ++e)
      if (column[e] == r) diagonal[r] = norm_of(e);
  std::vector<std::vector<Index>> of(a.rows());
  for (Index r = 0; r < a.rows(); ++r)
    for (Index e = first[r]; e < first[r + 1]; ++e) {
      const Index c = column[e];
      if (c != r && norm_of(e) > threshold * std::sqrt(diagonal[r] * diagonal[c]))
        of[r].push_back(c);
    }
  return of;
}

/// The aggregate of every row, or -1, and how many there are.
std::vector<Index> aggregate(const std::vector<std::vector<Index>>& coupled, Index& count) {
  const Index rows = Index(coupled.size());
  std::vector<Index> of(rows, -1);
  count = 0;
  const auto is_new = [&](Index r) { return of[r] < 0; };
  for (Index r = 0; r < rows; ++r) {
    if (coupled[r].empty() || !is_new(r)) continue;
    if (!std::all_of(coupled[r].begin(), coupled[r].end(), is_new)) continue;
    of[r] = count;
    for (const Index c : coupled[r]) of[c] = count;
    ++count;
  }
  const std::vector<Index> before = of;
  for (Index r = 0; r < rows; ++r) {
    if (!is_new(r)) continue;
    const auto has = [&](Index c) { return before[c] >= 0; };
    const auto near = std::find_if(coupled[r].begin(), coupled[r].end(), has);
    if (near != coupled[r].end()) of[r] = before[*near];
  }
  for (Index r = 0; r < rows; ++r) {
    if (coupled[r].empty() || !is_new(r)) continue;
    of[r] = count;
    for (const Index c : coupled[r])
      if (is_new(c)) of[c] = count;
    ++count;
  }
  return of;
}

/// Make the modes of an aggregate orthonormal: `modes` has six columns for each of its numbers.
/// Returns what brings the new columns back to the old ones, 6 x 6, upper right.
std::array<Real, 36> orthonormal(std::vector<Real>& modes) {
  const std::size_t numbers = modes.size() / 6;
  std::array<Real, 36> back{};
  for (int k = 0; k < 6; ++k) {
    Real own = 0, left = 0;
    for (std::size_t i = 0; i < numbers; ++i) own += modes[6 * i + k] * modes[6 * i + k];
    for (int turn = 0; turn < 2; ++turn)
      for (int j = 0; j < k; ++j) {
        Real along = 0;
        for (std::size_t i = 0; i < numbers; ++i) along += modes[6 * i + j] * modes[6 * i + k];
        back[6 * j + k] += along;
        for (std::size_t i = 0; i < numbers; ++i) modes[6 * i + k] -= along * modes[6 * i + j];
      }
    for (std::size_t i = 0; i < numbers; ++i) left += modes[6 * i + k] * modes[6 * i + k];
    constexpr Real dependent = 1e-16;
    const Real length = left > dependent * own ? std::sqrt(left) : 0;
    back[6 * k + k] = length;
    for (std::size_t i = 0; i < numbers; ++i)
      modes[6 * i + k] = length > 0 ? modes[6 * i + k] / length : 0;
  }
  return back;
}

}  // namespace

BlockRows prolongation(const BlockRows& a, Real threshold, RigidModes& modes) {
  Index count = 0;
  const std::vector<Index> of = aggregate(couplings(a, threshold), count);
  const Index width = a.height;
  std::vector<std::vector<Index>> members(count);
  for (Index r = 0; r < a.rows(); ++r)
    if (of[r] >= 0) members[of[r]].push_back(r);
  BlockRows plain{.height = width, .width = 6, .columns = count};
  std::vector<Index> first{0}, column;
  for (Index r = 0; r < a.rows(); ++r) {
    if (of[r] >= 0) column.push_back(of[r]);
    first.push_back(Index(column.size()));
  }
  std::vector<Real> block(column.size() * 6 * width);
  RigidModes coarse(std::size_t(count) * 36);
  for (Index g = 0; g < count; ++g) {
    std::vector<Real> own;
    for (const Index r : members[g])
      own.insert(own.end(), &modes[std::size_t(r) * 6 * width],
                 &modes[std::size_t(r) * 6 * width] + 6 * width);
    const std::array<Real, 36> back = orthonormal(own);
    std::copy(back.begin(), back.end(), &coarse[std::size_t(g) * 36]);
    for (std::size_t k = 0; k < members[g].size(); ++k)
      std::copy_n(&own[k * 6 * width], 6 * width,
                  &block[std::size_t(first[members[g][k]]) * 6 * width]);
  }
  modes.swap(coarse);
  plain.first.assign(first);
  plain.column.assign(column);
  plain.block.assign(block);

  // P = (I - weight D^-1 A) T
  const std::vector<Real> inverse = diagonal_inverses(a);
  const Real weight = 4 / (3 * largest_eigenvalue(a, inverse));
  BlockRows smooth = product(a, plain);
  const auto s_first = on_host(smooth.first), s_column = on_host(smooth.column);
  const auto s_block = on_host(smooth.block);
  std::vector<Real> part(6 * width);
  for (Index r = 0; r < a.rows(); ++r)
    for (Index e = s_first[r]; e < s_first[r + 1]; ++e) {
      Real* now = &s_block[std::size_t(e) * 6 * width];
      std::copy_n(now, 6 * width, part.begin());
      for (Index i = 0; i < width; ++i)
        for (Index j = 0; j < 6; ++j) {
          Real sum = 0;
          for (Index k = 0; k < width; ++k)
            sum += inverse[(std::size_t(r) * width + i) * width + k] * part[6 * k + j];
          now[6 * i + j] = -weight * sum;
        }
      if (s_column[e] == of[r])
        for (Index k = 0; k < 6 * width; ++k)
          now[k] += block[std::size_t(first[r]) * 6 * width + k];
    }
  return smooth;
}

BlockRows coarse_matrix(const BlockRows& a, const BlockRows& up, const BlockRows& down) {
  BlockRows coarse = product(down, product(a, up));
  const auto first = on_host(coarse.first), column = on_host(coarse.column);
  const auto block = on_host(coarse.block);
  const Index width = coarse.height;
  for (Index r = 0; r < coarse.rows(); ++r)
    for (Index e = first[r]; e < first[r + 1]; ++e)
      for (Index i = 0; i < width && column[e] == r; ++i) {
        Real& diagonal = block[std::size_t(e) * width * width + i * width + i];
        if (!(diagonal > 0)) diagonal = 1;
      }
  return coarse;
}

}  // namespace cdem
