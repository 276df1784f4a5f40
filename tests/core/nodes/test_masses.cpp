// Masses that move change, or all motion stops; the energy of it is booked.
#include "core/diagnostics/energy.hpp"
#include "core/nodes/masses.hpp"
#include "core/nodes/nodes.hpp"
#include "core/nodes/views.hpp"
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

namespace {

/// A tet bonded to a fixed one, and one that flies.
struct Pair : Scene {
  explicit Pair(Real strength = 1e9) {
    bonded = true;
    const Vec low{0, 0, -1}, high{0.3, 0.3, 1}, x{0, 0, 0}, y{1, 0, 0}, z{0, 1, 0};
    add<Tet4>({x, z, y, low}, true);
    add<Tet4>({x, y, z, high});
    Random random(1);
    add_tet(random, {9, 0, 0}, 1);
    build();
    set_interface(
        {{"cohesion", strength}, {"tensile_strength", strength}, {"friction_angle", 0.5}});
    model.lumped_while_bonded = true;
    set_motion(1, {0, 0, 5}, {1, 2, 3});
    start();
  }
};

}  // namespace

TEST_CASE("blocks move lumped masses while they have bonds") {
  Pair pair;
  for (Index i = 0; i < 8; ++i) CHECK(on_host(pair.state.nodes.lumped)[i] == 1);
  for (Index i = 8; i < 12; ++i) CHECK(on_host(pair.state.nodes.lumped)[i] == 0);
  CHECK(mass_columns(pair.model, pair.state).row(5) == -1);
  CHECK(mass_columns(pair.model, pair.state).row(9) >= 0);
  pair.state.nodes.lumped.resize(0);  // as of a restored state
  list_lumped(pair.model, pair.state);
  CHECK(on_host(pair.state.nodes.lumped)[4] == 1);
  CHECK(pair.state.stopped_energy == 0);
  pair.state.nodes.lumped.resize(0);
  pair.model.lumped_while_bonded = false;
  list_lumped(pair.model, pair.state);
  CHECK(pair.state.nodes.lumped.size() == 0);
}

TEST_CASE("the exact masses move from the last release on, and the difference is booked") {
  Pair pair;
  const Real before = energy_of_motion(pair.model, pair.state);
  const std::vector<Real> motion(pair.motion(0), pair.motion(12));
  on_host(pair.state.triangles.status)[0] = Flag(PairStatus::released);
  list_lumped(pair.model, pair.state);
  for (Index i = 0; i < 8; ++i) CHECK(on_host(pair.state.nodes.lumped)[i] == 0);
  const Real after = energy_of_motion(pair.model, pair.state);
  CHECK(after < before);
  CHECK(pair.state.stopped_energy == before - after);
  CHECK(relative_error(kinetic_energy(pair.model, pair.state), after - before) < 1e-14);
  CHECK(motion == std::vector<Real>(pair.motion(0), pair.motion(12)));
}

TEST_CASE("energy closes over a break that changes the masses") {
  Pair torn(1e4);
  torn.step(200);
  REQUIRE(on_host(torn.state.triangles.status)[0] == Flag(PairStatus::released));
  CHECK(on_host(torn.state.nodes.lumped)[4] == 0);
  CHECK(torn.state.stopped_energy > 0);
  CHECK(std::abs(energies(torn.model, torn.state).error) < 1e-3);
}

TEST_CASE("the energy of a rigid body is that of its mass and inertia") {
  Spinning tet;
  const Real mass = 4 * on_host(tet.model.mass)[0];
  tet.set_motion(0, {1, 2, 3});
  CHECK(relative_error(energy_of_motion(tet.model, tet.state), 0.5 * mass * 14) < 1e-14);
}

TEST_CASE("stopped motion is zero, and its energy is booked as damping") {
  Spinning tet;
  State& s = tet.state;
  tet.model.gravity = {0, 0, -10};
  const Real mass = 4 * on_host(tet.model.mass)[0], before = energy_of_motion(tet.model, s);
  s.dt_last = 0.01;
  Vec momentum{0, 0, 0};
  for (Index i = 0; i < 4; ++i) {
    put(s.nodes.force.data() + 4 * i, Vec{0, 0, -10 * on_host(tet.model.mass)[i]});
    momentum = momentum + on_host(tet.model.mass)[i] * tet.velocity(i);
  }
  stop_motion(tet.model, s);
  for (Index i = 0; i < 4; ++i) CHECK(norm(tet.velocity(i)) == 0);
  CHECK(s.dt_last == 0);
  // the weight has worked for half a step
  const Real work = 0.5 * 0.01 * -10 * momentum.z;
  CHECK(relative_error(s.stopped_energy, before + work) < 1e-14);
  Real external = 0;
  for (Index i = 0; i < 4; ++i) external += on_host(s.nodes.work_external)[i];
  CHECK(relative_error(external, work) < 1e-14);
  CHECK(mass > 0);
}

}  // namespace cdem::test
