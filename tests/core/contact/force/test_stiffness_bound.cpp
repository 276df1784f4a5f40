// The stiffness that bonds and contacts put on each node at most.
#include "core/contact/force/stiffness_bound.hpp"
#include "core/nodes/corner_lists.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

TEST_CASE("a live bond puts its share on its nodes, a released one nothing") {
  Scene scene;
  scene.bonded = true;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.add_box({0, 0, 1}, {1, 1, 1});
  scene.build();
  scene.set_interface({{"cohesion", 1e9}});
  scene.start();
  const PairSet& quads = scene.model.quads;
  const Real share = on_host(quads.stiffness)[0] * on_host(quads.area)[0] / 4;
  for (Index i = 0; i < 16; ++i)
    CHECK(on_host(scene.state.node_bonds)[i] == (scene.position(i).z == 1 ? share : 0));
  on_host(scene.state.quads.status)[0] = 0;
  list_corners(scene.model, scene.state);
  sum_bond_stiffness(scene.model, scene.state);
  for (Index i = 0; i < 16; ++i) CHECK(on_host(scene.state.node_bonds)[i] == 0);
}

TEST_CASE("the stiffness of contacts is not more than what is expected of them") {
  Random random(1);
  Scene scene;
  scene.add_box({-1, -1, -1}, {2, 2, 1}, true);
  scene.add_tet(random, {0, 0, 0.8}, 1);
  scene.build();
  scene.set_motion(1, {0.1, 0, -2}, {1, 2, 0});
  scene.start();
  Real most = 0;
  for (int n = 0; n < 300; ++n) {
    scene.step(1);
    for (Index i = 8; i < 12; ++i) {
      const Real now = on_host(scene.state.nodes.force)[4 * i + 3];
      CHECK(now <= on_host(scene.state.node_potential)[i]);
      most = std::max(most, now);
    }
  }
  CHECK(most > 0);
}

}  // namespace cdem::test
