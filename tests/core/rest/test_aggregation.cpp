// Coarser spaces: small inverses, eigenvalues, and rigid motions that they keep.
#include "core/rest/aggregation.hpp"
#include "core/rest/tangent.hpp"
#include "tests/core/rest/wall.hpp"

namespace cdem::test {

TEST_CASE("the inverse of a positive matrix; a row that depends on others stays out") {
  Random random(5);
  constexpr Index n = 7;
  std::vector<Real> root(n * n), a(n * n);
  for (Real& one : root) one = random.between(-1, 1);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      for (Index k = 0; k < n; ++k) a[i * n + j] += root[i * n + k] * root[j * n + k];
  std::vector<Real> inverse = a;
  invert(n, inverse.data());
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      Real sum = 0;
      for (Index k = 0; k < n; ++k) sum += a[i * n + k] * inverse[k * n + j];
      CHECK(std::abs(sum - (i == j)) < 1e-9);
    }
  Real twice[4] = {1, 1, 1, 1};
  invert(2, twice);
  CHECK(twice[0] == 1);
  CHECK(twice[1] == 0);
  CHECK(twice[3] == 0);
}

TEST_CASE("the largest eigenvalue, a tenth too large") {
  BlockRows a;
  a.height = a.width = 3, a.columns = 2;
  a.first.assign(std::vector<Index>{0, 1, 2});
  a.column.assign(std::vector<Index>{0, 1});
  a.block.assign(std::vector<Real>{1, 0, 0, 0, 2, 0, 0, 0, 3, 4, 0, 0, 0, 5, 0, 0, 0, 9});
  std::vector<Real> one(18);
  for (Index k = 0; k < 6; ++k) one[9 * (k / 3) + 4 * (k % 3)] = 1;
  CHECK(largest_eigenvalue(a, one) == doctest::Approx(1.1 * 9).epsilon(1e-3));
}

TEST_CASE("a prolongation keeps rigid motions, but at the base") {
  Wall wall;
  const NodeSystem t = tangent_of(wall.model, wall.state);
  std::vector<Vec3<Real>> place;
  for (Index i = 0; i < wall.model.node_count; ++i) place.push_back(wall.position(i));
  const RigidModes modes = rigid_modes(place, t.free);
  RigidModes coarse = modes;
  const BlockRows up = prolongation(t.matrix, 0, coarse);
  CHECK(up.columns > 1);
  CHECK(up.columns < wall.model.node_count / 4);
  Column<Real> of_aggregates, of_nodes;
  of_aggregates.resize(6 * std::size_t(up.columns));
  of_nodes.resize(3 * place.size());
  for (Index mode = 0; mode < 6; ++mode) {
    for (Index k = 0; k < 6 * up.columns; ++k) on_host(of_aggregates)[k] = coarse[6 * k + mode];
    multiply({}, up, of_aggregates.data(), of_nodes.data());
    for (Index i = wall.first_node(2 * Wall::across); i < wall.model.node_count; ++i)
      for (Index k = 0; k < 3; ++k)
        CHECK(std::abs(on_host(of_nodes)[3 * i + k] - modes[18 * i + 6 * k + mode]) < 1e-9);
  }
}

}  // namespace cdem::test
