// The tangent of a model: what may move, which nodes are one point, rigid motions.
#include "core/rest/tangent.hpp"
#include "tests/core/rest/wall.hpp"

namespace cdem::test {

TEST_CASE("nodes that bonds hold together are one point, and the base may not move") {
  Wall wall;
  const NodeSystem t = tangent_of(wall.model, wall.state);
  CHECK(t.points == 2 * (Wall::across + 1) * (Wall::rows + 1));
  for (Index i = 0; i < wall.model.node_count; ++i)
    for (Index k = 0; k < 3; ++k)
      CHECK(bool(t.free[3 * i + k]) == (i >= wall.first_node(Wall::across)));
}

TEST_CASE("a body that nothing holds may not move") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1}, true);
  scene.add_box({5, 0, 0}, {1, 1, 1});
  scene.build();
  scene.start();
  const NodeSystem t = tangent_of(scene.model, scene.state);
  CHECK(std::count(t.free.begin(), t.free.end(), Flag(1)) == 0);
  CHECK(t.points == scene.model.node_count);
}

TEST_CASE("a translation of the whole gives forces at the fixed base only") {
  Wall wall;
  const NodeSystem t = tangent_of(wall.model, wall.state);
  Column<Real> x, y;
  x.resize(t.free.size());
  y.resize(t.free.size());
  for (std::size_t i = 0; i < t.free.size(); ++i) on_host(x)[i] = t.free[i] ? Real(i % 3) - 1 : 0;
  multiply({}, t.matrix, x.data(), y.data());
  Real largest = 0;
  for (const Real one : on_host(y)) largest = std::max(largest, std::abs(one));
  for (Index i = wall.first_node(2 * Wall::across); i < wall.model.node_count; ++i)
    for (Index k = 0; k < 3; ++k) CHECK(std::abs(on_host(y)[3 * i + k]) < 1e-12 * largest);
}

}  // namespace cdem::test
