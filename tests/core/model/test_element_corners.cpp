// The corners of all elements by node.
#include "core/model/element_corners.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

TEST_CASE("a node has the corners of its elements, set after set and element after element") {
  Random random(1);
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.add_tet(random, {5, 0, 0}, 1);
  scene.add_tet(random, {9, 0, 0}, 1);
  scene.build();
  const Model& m = scene.model;
  const auto first = on_host(scene.state.nodes.element_first);
  const auto corner = on_host(scene.state.nodes.element_corner);
  const ElementCorners all = element_corners(m, scene.state);
  REQUIRE(first.size() == std::size_t(m.node_count) + 1);
  REQUIRE(corner.size() == 8 + 2 * 4);
  for (Index node = 0; node < m.node_count; ++node) {
    CHECK(first[node + 1] == first[node] + 1);
    bool found = false;
    all.with_element(corner[first[node]], [&](const ElementCorners::Set& set, Index i) {
      for (Index k = 0; k < set.corners; ++k) found = found || set.nodes.at(k, i) == node;
    });
    CHECK(found);
  }
  CHECK(corner[first[8]] == 0);       // the first corner of the first tet
  CHECK(corner[first[12] + 3] == 7);  // the last of the second
  CHECK(corner[first[0]] == 8);       // hexahedra come after tets
}

}  // namespace cdem::test
