// The way to rest of a static stage: kinetic or adaptive.
#include <vector>

#include "core/diagnostics/energy.hpp"
#include "core/diagnostics/unbalance.hpp"
#include "core/nodes/masses.hpp"
#include "core/nodes/relaxation.hpp"
#include "core/nodes/time_step.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A box with two fixed boxes bonded below and above: it sags under its weight.
struct Hanging : Scene {
  Hanging() {
    bonded = true;
    add_box({0, 0, 0}, {1, 1, 1}, true);
    add_box({0, 0, 1}, {1, 1, 1});
    add_box({0, 0, 2}, {1, 1, 1});
    build();
    set_interface({{"cohesion", 1e9}, {"tensile_strength", 1e9}, {"friction_angle", 0.5}});
    model.gravity = {0, 0, -10};
    model.lumped = true;
    start();
  }
  /// Stress of the lowest bond against the weight above it.
  Real carried() {
    Real sum = 0;
    for (Index i = 0; i < 8; ++i) sum += on_host(state.nodes.reaction)[4 * i + 2];
    return sum;
  }
};

}  // namespace

TEST_CASE("kinetic relaxation stops all motion when the kinetic energy has passed a peak") {
  State s;
  Model m;
  m.node_count = 1;
  s.nodes.sample.resize(4);
  const Real kinetic[] = {1, 3, 2, 1, 2};
  const bool due[] = {false, false, true, false, false};
  for (int k = 0; k < 5; ++k) {
    on_host(s.nodes.sample)[0] = kinetic[k];
    relax_kinetically(m, s);
    CHECK(s.stop_due == due[k]);
  }
  CHECK(s.kinetic_peak == 2);
}

TEST_CASE("either relaxation comes to rest, with the weight on the support") {
  for (const Relaxation relaxation : {Relaxation::kinetic, Relaxation::adaptive}) {
    Hanging hanging;
    const Report report = run(hanging.model, hanging.state,
                              {.steps = 20000, .unbalance_limit = 1e-7, .relaxation = relaxation});
    CHECK(report.outcome == Outcome::converged);
    CHECK(relative_error(hanging.carried(), 3 * 2500 * 10.0) < 2e-7);
  }
}

TEST_CASE("energies close while scaled masses grow and shrink a thousandfold") {
  Hanging hanging;
  Model& m = hanging.model;
  State& s = hanging.state;
  const Real bonds = on_host(s.node_bonds)[10], dt = s.dt;
  Real most = 0;
  for (int n = 0; n < 40; ++n) {
    run(m, s, {.steps = 3, .relaxation = Relaxation::adaptive});
    const Energies e = energies(m, s);
    CHECK(std::abs(e.error) < 2e-8);  // strains of 1e-4 are not quite linear
    most = std::max(most, e.terms[energy_term("kinetic")]);
    on_host(s.node_bonds)[10] = (n % 3 == 0 ? 1000 : 1) * bonds;
    renew_step(m, s);
  }
  CHECK(s.dt == dt);
  CHECK(most > 0);
  CHECK(s.stopped_energy > 0);
}

TEST_CASE("scaled masses count contacts twice, those that may begin only at nodes without bonds") {
  Hanging hanging;
  Model& m = hanging.model;
  State& s = hanging.state;
  run(m, s, {.steps = 1, .relaxation = Relaxation::adaptive});
  const auto masses = [&] {
    renew_step(m, s);
    const auto found = on_host(s.nodes.relax_mass);
    return std::vector<Real>(found.begin(), found.end());
  };
  Real* const potential = on_host(s.node_potential).data();
  Real* const bonds = on_host(s.node_bonds).data();
  Real* const acting = on_host(s.nodes.force).data() + 3;  // of a node's row of 4
  const Real spring = bonds[10];
  CHECK(spring > 0);
  const std::vector<Real> bare = masses();
  const auto gained = [&](Index i, Real held, Real may_begin, Real acts) {
    const Real before[] = {bonds[i], potential[i], acting[4 * i]};
    bonds[i] = held, potential[i] = 0, acting[4 * i] = 0;
    const Real without = masses()[i];
    potential[i] = may_begin, acting[4 * i] = acts;
    const Real with = masses()[i];
    bonds[i] = before[0], potential[i] = before[1], acting[4 * i] = before[2];
    return with - without;
  };
  // in units of what a bond of the same stiffness adds
  const Real unit = gained(10, spring, 0.01 * spring, 0);
  CHECK(unit > 0);
  CHECK(relative_error(gained(10, spring, 0, 0.01 * spring), 2 * unit) < 1e-9);
  CHECK(relative_error(gained(10, 0, 0, 0.01 * spring), 2 * unit) < 1e-9);
  CHECK(relative_error(gained(10, 0, 0.01 * spring, 0), 2 * unit) < 1e-9);
  CHECK(masses() == bare);
}

TEST_CASE("a node that becomes heavier keeps its momentum, a lighter one its velocity") {
  Hanging hanging;
  Model& m = hanging.model;
  State& s = hanging.state;
  run(m, s, {.steps = 5, .relaxation = Relaxation::adaptive});
  const Real bonds = on_host(s.node_bonds)[10];
  const auto momentum = [&] { return on_host(s.nodes.relax_mass)[10] * hanging.velocity(10); };
  const Vec before = momentum();
  on_host(s.node_bonds)[10] = 1000 * bonds;
  renew_step(m, s);
  slow_heavier_nodes(m, s);
  CHECK(distance(momentum(), before) < 1e-14 * norm(before));
  on_host(s.nodes.relax)[8 * 10 + 3] = 1;
  const Vec velocity = hanging.velocity(10);
  on_host(s.node_bonds)[10] = bonds;
  renew_step(m, s);
  slow_heavier_nodes(m, s);
  CHECK(distance(hanging.velocity(10), velocity) == 0);
}

}  // namespace cdem::test
