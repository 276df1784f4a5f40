// The stable time step, its growth, and masses scaled for it.
#include "core/nodes/masses.hpp"
#include "core/nodes/time_step.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A box that floats, with the highest frequency that a node is given; no contacts.
struct Floating : Scene {
  explicit Floating(bool fixed = false) {
    add_box({0, 0, 0}, {1, 1, 1}, fixed);
    build();
    start();
  }
  void set_frequency(Index node, Real frequency) {
    on_host(model.frequency_squared)[node] = frequency * frequency;
  }
};

}  // namespace

TEST_CASE("the stable step is two over the highest frequency of a node that can move") {
  Floating floating;
  floating.set_frequency(3, 1e5);
  const StepLimit limit = step_limit(floating.model, floating.state);
  CHECK(limit.node == 3);
  CHECK(relative_error(limit.dt, 2 / 1e5) < 1e-15);
  CHECK(limit.contact_frequency_squared == 0);
}

TEST_CASE("what is held counts only where nothing else is") {
  Floating held(true);
  held.set_frequency(2, 1e6);
  CHECK(step_limit(held.model, held.state).node == 2);
  Scene both;
  both.add_box({0, 0, 0}, {1, 1, 1}, true);
  both.add_box({5, 0, 0}, {1, 1, 1});
  both.build();
  both.start();
  on_host(both.model.frequency_squared)[2] = 1e12;
  CHECK(step_limit(both.model, both.state).node >= 8);
}

TEST_CASE("springs add twice their stiffness over the mass, Gershgorin") {
  Floating floating;
  on_host(floating.state.node_bonds)[5] = 1e9;
  on_host(floating.state.node_potential)[5] = 3e8;
  on_host(floating.state.nodes.force)[4 * 5 + 3] = 5e8;  // more than was expected
  const StepLimit limit = step_limit(floating.model, floating.state);
  CHECK(limit.node == 5);
  CHECK(relative_error(limit.contact_frequency_squared,
                       2 * 1.5e9 / on_host(floating.model.mass)[5]) < 1e-15);
}

TEST_CASE("lumped masses bound the step of a block with bonds, exact ones that of others") {
  Scene tet;
  Random random(1);
  tet.add_tet(random, {0, 0, 0}, 1);
  tet.build();
  tet.start();
  on_host(tet.state.node_bonds)[0] = 1e8;
  Model& m = tet.model;
  for (Index i = 0; i < 4; ++i) {  // the mass matrix of a tet has 5 times the inverse
    on_host(m.lumped_frequency_squared)[i] = 1e8;
    on_host(m.frequency_squared)[i] = 5e8;
    on_host(m.inverse_mass_bound)[i] = 5 / on_host(m.mass)[i];
  }
  const Real exact = step_limit(m, tet.state).dt;
  tet.state.nodes.lumped.resize(4);
  for (Index i = 0; i < 4; ++i) on_host(tet.state.nodes.lumped)[i] = 1;
  CHECK(relative_error(step_limit(m, tet.state).dt, std::sqrt(5.0) * exact) < 1e-14);
}

TEST_CASE("strong contact damping shortens the step with one over its ratio") {
  Floating floating;
  const auto with = [&](Real ratio) {
    floating.model.contact_damping = ratio;
    return step_limit(floating.model, floating.state).dt;
  };
  CHECK(relative_error(with(0.1) / with(0.0), std::sqrt(1.01) - 0.1) < 1e-14);
  CHECK(relative_error(with(0.2), with(0.1) / 2) < 1e-14);
  CHECK(relative_error(with(2.0), with(0.1) / 20) < 1e-14);
}

TEST_CASE("with a diagonal below the mass matrix, nodes of a block count one by one") {
  Scene tet;
  Random random(1);
  tet.add_tet(random, {0, 0, 0}, 1);
  tet.build();
  Model& m = tet.model;
  on_host(m.support)[2] = 0;
  m.support_component.assign(std::array<Flag, 3>{1, 1, 1}.data(), 3);
  m.support_curve.assign(std::array<Index, 3>{0, 0, 0}.data(), 3);
  m.support_velocity.assign(std::array<Real, 3>{0, 0, 0}.data(), 3);
  tet.start();
  for (Index i = 0; i < 4; ++i) {
    on_host(m.lumped_frequency_squared)[i] = 1e6;
    on_host(m.frequency_squared)[i] = 5e6;
    on_host(m.inverse_mass_bound)[i] = 5 / on_host(m.mass)[i];
  }
  on_host(tet.state.node_bonds)[1] = 1e9;
  on_host(tet.state.node_bonds)[2] = 1e12;  // held: it moves nothing
  m.least_mass.resize(4);
  for (Index i = 0; i < 4; ++i) on_host(m.least_mass)[i] = 0.2 * on_host(m.mass)[i];
  on_host(m.least_mass)[1] = 40 * on_host(m.mass)[1];
  const Real light = 5e6, heavy = (on_host(m.mass)[1] * 1e6 + 2e9) / on_host(m.least_mass)[1];
  const StepLimit limit = step_limit(m, tet.state);
  CHECK(relative_error(limit.dt, 2 / std::sqrt(std::max(light, heavy))) < 1e-14);
  CHECK(relative_error(limit.element_frequency_squared + limit.contact_frequency_squared,
                       std::max(light, heavy)) < 1e-14);
}

TEST_CASE("damping shortens the step") {
  Floating floating;
  const Real free = step_limit(floating.model, floating.state).dt;
  floating.model.stiffness_damping = 0.2;
  const Real damped = step_limit(floating.model, floating.state).dt;
  CHECK(relative_error(damped, free * (std::sqrt(1.04) - 0.2)) < 1e-14);
  floating.model.damping.local = 0.8;
  CHECK(relative_error(step_limit(floating.model, floating.state).dt, damped / std::sqrt(1.8)) <
        1e-14);
}

TEST_CASE("damping of rock shortens the step, and a stage's step can be asked for") {
  Floating floating;
  Model& m = floating.model;
  const Real free = step_limit(m, floating.state).dt, w = 2 / free;
  const Real mass = 0.4 * w, time = 0.6 / w, xi = 0.5 * (0.4 + 0.6);
  const MaxwellBranches branches{.weight = {0.1, 0.2, 0.3}, .rate = {1, 2, 3}};
  StageDamping rayleigh{}, maxwell{};
  rayleigh.nodes = {0, mass};
  rayleigh.time = time;
  maxwell.maxwell = branches;
  CHECK(relative_error(stable_step(m, floating.state, rayleigh),
                       free * (std::sqrt(1 + xi * xi) - xi)) < 1e-14);
  CHECK(relative_error(stable_step(m, floating.state, maxwell), free / std::sqrt(1.6)) < 1e-14);
  CHECK(step_limit(m, floating.state).dt == free);
}

TEST_CASE("the coming step shrinks at once and grows by one per cent") {
  Floating floating;
  State& s = floating.state;
  const Real before = s.dt;
  CHECK(relative_error(before, 0.8 * step_limit(floating.model, s).dt) < 1e-15);
  on_host(s.node_bonds)[0] = 1e10;
  renew_step(floating.model, s);
  const Real short_step = s.dt;
  CHECK(short_step < 0.5 * before);
  on_host(s.node_bonds)[0] = 0;
  renew_step(floating.model, s);
  CHECK(s.dt == short_step);
  CHECK(relative_error(s.dt_stable, flight_growth * before) < 1e-15);
  advance_clock(s);
  CHECK(s.dt_last == short_step);
  CHECK(s.time == short_step);
  CHECK(relative_error(s.dt, step_growth * short_step) < 1e-15);
  for (int n = 0; n < 500; ++n) {
    advance_clock(s);
    renew_step_if_due(floating.model, s);
  }
  CHECK(s.dt == s.dt_stable);
}

TEST_CASE("where contacts limit the step it grows back to all of the stable one") {
  Floating floating;
  State& s = floating.state;
  on_host(s.node_bonds)[0] = 1e10;
  renew_step(floating.model, s);
  on_host(s.node_bonds)[0] = 5e9;
  renew_step(floating.model, s);
  CHECK(s.dt < s.dt_stable);
  CHECK(relative_error(s.dt_stable, 0.8 * step_limit(floating.model, s).dt) < 1e-15);
}

TEST_CASE("a given step is taken as it is") {
  Floating floating;
  floating.model.step_given = 1e-7;
  renew_step(floating.model, floating.state);
  CHECK(floating.state.dt == 1e-7);
  floating.model.step_given = 1e-3;
  renew_step(floating.model, floating.state);
  CHECK(floating.state.dt == 1e-3);
}

TEST_CASE("scaled masses make the present step stable, and their motion is booked") {
  Floating floating;
  Model& m = floating.model;
  State& s = floating.state;
  m.lumped = true;
  floating.set_motion(0, {1, 2, 3});
  const Real before = energy_of_motion(m, s);
  s.dt *= 10;
  scale_masses(m, s);
  const Real booked = s.stopped_energy;
  CHECK(relative_error(before - energy_of_motion(m, s), booked) < 1e-14);
  for (Index i = 0; i < m.node_count; ++i) {
    const Real frequency = std::sqrt(on_host(m.mass)[i] * on_host(m.lumped_frequency_squared)[i] /
                                     on_host(s.nodes.relax_mass)[i]);
    CHECK(relative_error(frequency * s.dt, 2 * relax_safety) < 5e-16);
  }
}

}  // namespace cdem::test
