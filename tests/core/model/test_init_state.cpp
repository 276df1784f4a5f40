// A new state has its arrays, and its nodes in place.
#include "core/model/init_state.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

TEST_CASE("nodes are in place and at rest; pairs are bonded; nothing is stored or lost") {
  Scene scene;
  scene.bonded = true;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.add_box({0, 0, 1}, {1, 1, 1});
  scene.build();
  const State& s = scene.state;
  CHECK(s.nodes.motion.size() == 8 * 16);
  CHECK(distance(scene.position(15), Vec{0, 1, 2}) == 0);
  for (Index i = 0; i < 16; ++i) CHECK(norm(scene.velocity(i)) == 0);
  REQUIRE(scene.model.quads.count == 1);
  CHECK(on_host(s.quads.status)[0] == 1);
  CHECK(on_host(s.quads.jump_at_break)[0] == -1);
  for (Index k = 0; k < 4; ++k) {
    CHECK(on_host(s.quads.bond)[k * scene.model.quads.point_stride] == 1);
    CHECK(on_host(s.quads.slip1)[k * scene.model.quads.point_stride] == 0);
  }
  CHECK(s.hex8.point_stress.size() == 0);
  CHECK(on_host(s.hex8.energy)[0] == 0);
}

TEST_CASE("incremental forms keep the stress of every Gauss point") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.model.formulation = Formulation::incremental;
  scene.build();
  CHECK(scene.state.hex8.point_stress.size() == 6 * 8 * std::size_t(scene.model.hex8.stride));
}

TEST_CASE("the row after the last adds nothing, whatever the sign of a zero") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.build();
  const Column<Real>& force = scene.state.corner_force;
  for (std::size_t k = 4 * std::size_t(scene.model.corner_rows); k < force.size(); ++k)
    CHECK(same_bits(on_host(force)[k], -0.0));
  CHECK(same_bits(-0.0 + on_host(force)[force.size() - 1], -0.0));
}

}  // namespace cdem::test
