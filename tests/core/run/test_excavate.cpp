// Blocks that are dug out: the forces that they bore stay as loads, and are let go.
#include "core/diagnostics/energy.hpp"
#include "core/run/excavate.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A box bonded to a fixed one below, with another on top of it that only lies there.
struct Tower : Scene {
  Index middle, high;
  Tower() {
    bonded = true;
    add_box({0, 0, 0}, {1, 1, 1}, true);
    middle = add_box({0, 0, 1}, {1, 1, 1});
    high = add_box({0.1, 0.1, 2.0}, {0.7, 0.7, 0.7});
    build();
    model.gravity = {0, 0, -10};
    model.damping.local = 0.8;
    set_interface({{"cohesion", 1e9}, {"tensile_strength", 1e9}, {"friction_angle", 0.5}});
    start();
    step(4000);
  }
  void dig(Index block) {
    std::vector<Flag> leaves(model.node_count);
    for (Index i = 0; i < node_count(block); ++i) leaves[first_node(block) + i] = 1;
    excavate(model, state, leaves.data());
  }
  Vec relief() const {
    Vec sum{0, 0, 0};
    for (Index i = 0; i < model.node_count; ++i)
      sum = sum + vector_at(state.nodes.relief.data() + 4 * std::size_t(i));
    return sum;
  }
  Real weight(Index block) const {
    Real sum = 0;
    for (Index i = 0; i < node_count(block); ++i)
      sum += on_host(model.gravity_mass)[first_node(block) + i];
    return 10 * sum;
  }
};

}  // namespace

TEST_CASE("a block that lay on another bears on it until it is let go") {
  Tower tower;
  const Real weight = tower.weight(tower.high);
  const Index top = tower.first_node(tower.middle);
  tower.dig(tower.high);
  CHECK(distance(tower.relief(), Vec{0, 0, -weight}) < 1e-6 * weight);
  const Vec before = tower.position(top);
  tower.step(2000);
  CHECK(distance(tower.position(top), before) < 1e-9);
  release_forces(tower.state, 0, tower.state.time);
  tower.step(2000);
  CHECK(tower.state.relief.part == 0);
}

TEST_CASE("a bonded block that is dug out lets its mate be touched, and keeps what it bore") {
  Tower tower;
  const Real both = tower.weight(tower.middle) + tower.weight(tower.high);
  const std::size_t exposed = tower.state.search.exposed_face.size();
  tower.dig(tower.middle);
  // five of its faces leave, the mate of the sixth comes
  CHECK(tower.state.search.exposed_face.size() == exposed - 5 + 1);
  // on the fixed block it pressed with both weights, the block above it held up with its own
  const Vec up{0, 0, tower.weight(tower.high)};
  CHECK(distance(tower.relief(), Vec{0, 0, -both} + up) < 1e-6 * both);
  const Vec before = tower.position(tower.first_node(tower.high));
  tower.step(1000);
  CHECK(distance(tower.position(tower.first_node(tower.high)), before) < 1e-9);
}

TEST_CASE("what was kept of an earlier excavation adds up by the part that is left") {
  Tower tower;
  tower.dig(tower.high);
  release_forces(tower.state, 0.25, tower.state.time);
  tower.step(2000);
  const Real before = norm(tower.relief());
  std::vector<Flag> none(tower.model.node_count);
  excavate(tower.model, tower.state, none.data());
  CHECK(norm(tower.relief()) == doctest::Approx(0.25 * before));
  CHECK(tower.state.relief.at(tower.state.time) == 1);
}

TEST_CASE("forces are let go evenly over a time") {
  State s;
  s.time = 2;
  release_forces(s, 0.2, 6);
  CHECK(s.relief.at(2) == 1);
  CHECK(s.relief.at(4) == doctest::Approx(0.6));
  CHECK(s.relief.at(9) == 0.2);
  s.time = 4;
  release_forces(s, 0, 4);  // at once
  CHECK(s.relief.at(4) == 0);
}

}  // namespace cdem::test
