// Masses that move change, or all motion stops; the energy of it is booked.
#include "core/nodes/masses.hpp"
#include "core/nodes/nodes.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

struct Spinning : Scene {
  Spinning() {
    Random random(1);
    add_tet(random, {0, 0, 0}, 1);
    build();
    set_motion(0, {1, 2, 3}, {4, 5, 6});
    start();
  }
};

}  // namespace

TEST_CASE("lumped masses have more inertia than the exact ones: the difference is booked") {
  Spinning tet;
  const Real before = energy_of_motion(tet.model, tet.state);
  change_mass(tet.model, tet.state, true);
  CHECK(tet.model.lumped);
  const Real lumped = energy_of_motion(tet.model, tet.state);
  CHECK(lumped > before);
  CHECK(tet.state.stopped_energy == before - lumped);
  CHECK(relative_error(kinetic_energy(tet.model, tet.state), lumped - before) < 1e-14);
  change_mass(tet.model, tet.state, false);
  CHECK(energy_of_motion(tet.model, tet.state) == before);
  CHECK(std::abs(tet.state.stopped_energy) < 1e-12 * before);
}

TEST_CASE("the energy of a rigid body is that of its mass and inertia") {
  Spinning tet;
  const Real mass = 4 * tet.model.mass[0];
  tet.set_motion(0, {1, 2, 3});
  CHECK(relative_error(energy_of_motion(tet.model, tet.state), 0.5 * mass * 14) < 1e-14);
}

TEST_CASE("stopped motion is zero, and its energy is booked as damping") {
  Spinning tet;
  State& s = tet.state;
  tet.model.gravity = {0, 0, -10};
  const Real mass = 4 * tet.model.mass[0], before = energy_of_motion(tet.model, s);
  s.dt_last = 0.01;
  Vec momentum{0, 0, 0};
  for (Index i = 0; i < 4; ++i) {
    put(s.nodes.force.data() + 4 * i, Vec{0, 0, -10 * tet.model.mass[i]});
    momentum = momentum + tet.model.mass[i] * tet.velocity(i);
  }
  stop_motion(tet.model, s);
  for (Index i = 0; i < 4; ++i) CHECK(norm(tet.velocity(i)) == 0);
  CHECK(s.dt_last == 0);
  // the weight has worked for half a step
  const Real work = 0.5 * 0.01 * -10 * momentum.z;
  CHECK(relative_error(s.stopped_energy, before + work) < 1e-14);
  Real external = 0;
  for (Index i = 0; i < 4; ++i) external += s.nodes.work_external[i];
  CHECK(relative_error(external, work) < 1e-14);
  CHECK(mass > 0);
}

}  // namespace cdem::test
