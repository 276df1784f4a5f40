// solve.hpp - linear systems over the displacements of nodes, for Python.
#pragma once

#include <stdexcept>

#include "bindings/arrays.hpp"
#include "core/rest/conjugate_gradients.hpp"

namespace cdem {

/// Solve K u = f for several f, the rows of `right`. K comes by entries of 3 x 3 blocks, sorted by
/// rows and columns. Empty where one was not solved for.
inline nb::ndarray<nb::numpy, Real> solve_blocks(const nb::dict& system, Array<Real> right,
                                                 Real part, int most_iterations) {
  const auto take = [&]<class T>(const char* name, std::vector<T>& to) {
    const auto from = nb::cast<Array<T>>(system[name]);
    to.assign(from.data(), from.data() + from.size());
  };
  NodeSystem s;
  std::vector<Index> first, column;
  std::vector<Real> block, place;
  take("first", first), take("column", column), take("block", block), take("place", place);
  take("group_first", s.group_first), take("point", s.point);
  s.matrix.columns = Index(first.size()) - 1;
  s.matrix.first.assign(first);
  s.matrix.column.assign(column);
  s.matrix.block.assign(block);
  const std::size_t numbers = place.size();
  for (std::size_t i = 0; i < numbers; i += 3)
    s.place.push_back({place[i], place[i + 1], place[i + 2]});
  for (const Index point : s.point) s.points = std::max(s.points, point + 1);
  s.free.assign(numbers, 1);
  Multigrid inverse(std::move(s));
  GradientVectors vectors;
  std::vector<Real> answers;
  for (std::size_t k = 0; k < right.shape(0); ++k) {
    vectors.r.assign(right.data() + k * numbers, numbers);
    if (solve_by_gradients({}, inverse, part, most_iterations, vectors) < 0)
      return array_of<Real>({});
    const auto x = on_host(vectors.x);
    answers.insert(answers.end(), x.begin(), x.end());
  }
  return array_of(std::move(answers));
}

}  // namespace cdem
