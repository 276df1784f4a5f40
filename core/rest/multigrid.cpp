// multigrid.cpp - see multigrid.hpp.
#include "core/rest/multigrid.hpp"

#include <cmath>

#include "core/base/primitives.hpp"
#include "core/rest/products.hpp"

namespace cdem {

namespace {

constexpr Index solved_directly = 400;  // numbers of the last level
constexpr std::size_t most_levels = 16;
constexpr int sweeps = 2;  // on all levels but the first, before and after the coarser ones

/// The numbers of a vector at which groups of rows begin.
std::vector<Index> numbers_of_groups(const std::vector<Index>& group_first) {
  std::vector<Index> first;
  for (const Index row : group_first) first.push_back(3 * row);
  return first;
}

std::vector<Index> groups_of_rows(const BlockRows& a) {
  std::vector<Index> first(a.rows() + 1);
  for (Index r = 0; r <= a.rows(); ++r) first[r] = r * a.height;
  return first;
}

/// Invert the diagonal blocks of the groups.
void invert_groups(Level& level, const std::vector<Index>& group_first) {
  const BlockRows& a = level.matrix;
  const auto first = on_host(a.first), column = on_host(a.column);
  const auto block = on_host(a.block);
  const Index groups = Index(group_first.size()) - 1, width = a.height;
  std::vector<std::size_t> start(groups + 1);
  for (Index g = 0; g < groups; ++g) {
    const std::size_t n = group_first[g + 1] - group_first[g];
    start[g + 1] = start[g] + n * n;
  }
  level.inverse.resize(start.back());
  const auto inverse = on_host(level.inverse);
  for (Index g = 0; g < groups; ++g) {
    const Index begin = group_first[g] / width, end = group_first[g + 1] / width;
    const Index n = group_first[g + 1] - group_first[g];
    for (Index r = begin; r < end; ++r)
      for (Index e = first[r]; e < first[r + 1]; ++e)
        for (Index k = 0; k < width * width && begin <= column[e] && column[e] < end; ++k)
          inverse[start[g] + std::size_t((r - begin) * width + k / width) * n +
                  (column[e] - begin) * width + k % width] =
              block[std::size_t(e) * width * width + k];
    invert(n, &inverse[start[g]]);
  }
  level.group_first.assign(group_first);
  level.inverse_of.assign(start);
}

void smooth(Queue q, const Level& level, const Real* r, Real* x) {
  for_each_item(q, Index(level.group_first.size()) - 1,
                SmoothGroup{.first = level.group_first.data(),
                            .inverse_of = level.inverse_of.data(),
                            .inverse = level.inverse.data(),
                            .r = r,
                            .weight = level.weight,
                            .x = x});
}

/// A weight at which smoothing converges, from the largest eigenvalue of B^-1 A.
Real weight_of(Level& level) {
  const Index numbers = level.matrix.rows() * level.matrix.height;
  const auto start = on_host(level.x);
  for (Index i = 0; i < numbers; ++i)
    start[i] = (i % 2 ? -1.0 : 1.0) * (1 + Real(i * std::int64_t(7919) % 101) / 101);
  level.weight = 1;
  Real largest = 1;
  for (int turn = 0; turn < 10; ++turn) {
    const auto before = on_host(level.x);
    Real square = 0, after = 0;
    for (Index i = 0; i < numbers; ++i) square += before[i] * before[i];
    for (Index i = 0; i < numbers; ++i) before[i] /= std::sqrt(square);
    multiply({}, level.matrix, level.x.data(), level.left.data());
    set_all({}, numbers, level.x.data(), 0.0);
    smooth({}, level, level.left.data(), level.x.data());
    const auto x = on_host(level.x);
    for (Index i = 0; i < numbers; ++i) after += x[i] * x[i];
    if (!(after > 0)) break;
    largest = std::sqrt(after);
  }
  return 4 / (3 * 1.1 * largest);
}

void finish_level(Level& level, const std::vector<Index>& groups) {
  const std::size_t numbers = std::size_t(level.matrix.rows()) * level.matrix.height;
  for (Column<Real>* vector : {&level.right, &level.x, &level.left}) vector->resize(numbers);
  invert_groups(level, groups);
  level.weight = weight_of(level);
}

/// From points to the nodes that are there: as far as they may move.
BlockRows points_to_nodes(const NodeSystem& t) {
  const Index nodes = t.matrix.rows();
  BlockRows up{.height = 3, .width = 3, .columns = t.points};
  std::vector<Index> first(nodes + 1);
  std::vector<Real> block(9 * std::size_t(nodes));
  for (Index i = 0; i < nodes; ++i) {
    first[i + 1] = i + 1;
    for (Index k = 0; k < 3; ++k)
      block[9 * std::size_t(i) + 4 * k] = t.free[3 * std::size_t(i) + k] ? 1 : 0;
  }
  up.first.assign(first);
  up.column.assign(t.point);
  up.block.assign(block);
  return up;
}

/// Rigid motions of the points; a component may move if that of one of its nodes may.
RigidModes modes_of_points(const NodeSystem& t) {
  std::vector<Vec3<Real>> place(t.points);
  std::vector<Flag> free(3 * std::size_t(t.points));
  for (std::size_t i = 0; i < t.place.size(); ++i) {
    place[t.point[i]] = t.place[i];
    for (Index k = 0; k < 3; ++k)
      if (t.free[3 * i + k]) free[3 * std::size_t(t.point[i]) + k] = 1;
  }
  return rigid_modes(place, free);
}

}  // namespace

Multigrid::Multigrid(NodeSystem&& t) {
  const Transfer transfer;
  RigidModes modes = modes_of_points(t);
  const auto add_coarser = [&](BlockRows&& up) {
    Level& above = levels_.back();
    above.up = std::move(up);
    above.down = transposed(above.up);
    BlockRows coarse = coarse_matrix(above.matrix, above.up, above.down);
    levels_.emplace_back();
    levels_.back().matrix = std::move(coarse);
  };
  const bool shares_points = t.points < t.matrix.rows();
  BlockRows to_nodes;
  if (shares_points) to_nodes = points_to_nodes(t);
  levels_.emplace_back();
  levels_.back().matrix = std::move(t.matrix);
  finish_level(levels_.back(), numbers_of_groups(t.group_first));
  if (shares_points) {
    add_coarser(std::move(to_nodes));
    finish_level(levels_.back(), groups_of_rows(levels_.back().matrix));
  }
  Real threshold = 0.02;
  while (levels_.size() < most_levels) {
    const BlockRows& a = levels_.back().matrix;
    const Index numbers = a.rows() * a.height;
    if (numbers <= solved_directly) break;
    BlockRows up = prolongation(a, threshold, modes);
    if (up.columns == 0 || up.columns * 6 > 0.9 * numbers) break;
    add_coarser(std::move(up));
    finish_level(levels_.back(), groups_of_rows(levels_.back().matrix));
    threshold = 0;
  }
  const BlockRows& a = levels_.back().matrix;
  const Index n = a.rows() * a.height;
  if (n > 4 * solved_directly) return;  // no coarser space was found: it is smoothed alone
  last_.resize(std::size_t(n) * n);
  const auto first = on_host(a.first), column = on_host(a.column);
  const auto block = on_host(a.block);
  for (Index r = 0; r < a.rows(); ++r)
    for (Index e = first[r]; e < first[r + 1]; ++e)
      for (Index k = 0; k < a.height * a.width; ++k)
        last_[std::size_t(r * a.height + k / a.width) * n + column[e] * a.width + k % a.width] =
            block[std::size_t(e) * a.block_size_of() + k];
  invert(n, last_.data());
}

void Multigrid::solve_last(const Real* right, Real* x) const {
  const Transfer transfer;
  wait_for_launches();
  const BlockRows& a = levels_.back().matrix;
  const Index n = a.rows() * a.height;
  for (Index i = 0; i < n; ++i) {
    Real sum = 0;
    for (Index j = 0; j < n; ++j) sum += last_[std::size_t(i) * n + j] * right[j];
    x[i] = sum;
  }
}

void Multigrid::cycle(Queue q, std::size_t number, const Real* right, Real* x) {
  Level& level = levels_[number];
  const bool is_last = number + 1 == levels_.size();
  if (is_last && !last_.empty()) return solve_last(right, x);
  set_all(q, level.matrix.rows() * level.matrix.height, x, 0.0);
  const int turns = number == 0 ? 1 : sweeps;
  smooth(q, level, right, x);
  for (int turn = 1; turn < turns; ++turn) {
    residual(q, level.matrix, right, x, level.left.data());
    smooth(q, level, level.left.data(), x);
  }
  if (!is_last) {
    Level& next = levels_[number + 1];
    residual(q, level.matrix, right, x, level.left.data());
    multiply(q, level.down, level.left.data(), next.right.data());
    cycle(q, number + 1, next.right.data(), next.x.data());
    multiply_add(q, level.up, next.x.data(), x);
  }
  for (int turn = 0; turn < turns; ++turn) {
    residual(q, level.matrix, right, x, level.left.data());
    smooth(q, level, level.left.data(), x);
  }
}

void Multigrid::apply(Queue q, const Real* r, Real* z) { cycle(q, 0, r, z); }

}  // namespace cdem
