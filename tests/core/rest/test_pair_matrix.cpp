// Matrices of bonded pairs: forces change by them where a node moves a little.
#include "core/bonds/views.hpp"
#include "core/rest/pair_matrix.hpp"
#include "tests/core/rest/moved_nodes.hpp"

namespace cdem::test {

TEST_CASE("bonds between boxes that are turned, at the vertices and inside") {
  for (const Real indentation : {0.0, 0.3}) {
    Random random(4);
    Scene scene;
    scene.bonded = true;
    scene.add_box({0, 0, 0}, {1, 1, 1});
    scene.add_box({0, 0, 1}, {1, 1, 1});
    scene.build();
    scene.set_interface({{"cohesion", 1e9}, {"tensile_strength", 1e9}, {"friction_angle", 0.5}});
    turn(scene, random.rotation());
    const PairSet& set = scene.model.quads;
    const ConformingBonds<4> bonds{
        .nodes = {scene.state.nodes.motion.data()},
        .pair_nodes = {set.nodes.data(), set.stride},
        .pairs = pair_columns(scene.model, set, scene.state.quads),
        .indentation = indentation,
        .dt = 1,
        .sampled = false,
        .corner_force = {scene.state.corner_force.data() + 4 * std::size_t(set.corner_first)}};
    check_matrix(scene, pair_matrix(bonds, One{0}), [&] {
      WithLaws<ConformingBonds<4>, BrittleAlone>{bonds}(One{0});
      std::vector<Vec> force(8);
      for (Index k = 0; k < 4; ++k) {
        force[4 + k] = vector_at(bonds.corner_force.rows + 4 * k);
        force[k] = -force[4 + k];
      }
      return force;
    });
  }
}

}  // namespace cdem::test
