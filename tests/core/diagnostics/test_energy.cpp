// The energy ledger.
#include "core/diagnostics/energy.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

TEST_CASE("a body that spins and vibrates keeps its energy") {
  Random random(1);
  Scene scene;
  scene.add_tet(random, {0, 0, 0}, 1);
  scene.build();
  scene.set_motion(0, {1, 0, 0}, {0, 3, 1});
  scene.motion(2)[4] += 2;
  scene.start();
  scene.step(200);
  const Energies e = energies(scene.model, scene.state);
  CHECK(e.start > 0);
  // central differences keep it exactly where forces are linear, which those of a spin are not
  CHECK(relative_error(e.terms[energy_term("kinetic")] + e.terms[energy_term("strain")], e.start) <
        1e-5);
  CHECK(std::abs(e.error) < 1e-5);
  for (std::size_t k = 0; k < energy_term_count; ++k)
    if (k != energy_term("kinetic") && k != energy_term("strain"))
      CHECK(std::abs(e.terms[k]) < 1e-12 * e.start);
}

TEST_CASE("a body that falls gains what its weight has done") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.build();
  scene.model.gravity = {0, 0, -10};
  scene.start();
  scene.step(200);
  const Energies e = energies(scene.model, scene.state);
  CHECK(e.terms[energy_term("external")] > 0);
  CHECK(relative_error(e.terms[energy_term("kinetic")], e.terms[energy_term("external")]) < 1e-9);
}

TEST_CASE("a ledger that is closed books the missing energy as damping, and goes on from there") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.build();
  scene.model.gravity = {0, 0, -10};
  scene.start();
  scene.step(100);
  const Energies before = energies(scene.model, scene.state);
  scene.state.energy_start += 0.1 * before.terms[energy_term("external")];
  CHECK(relative_error(energies(scene.model, scene.state).error, -0.1) < 1e-6);
  close_ledger(scene.model, scene.state);
  const Energies closed = energies(scene.model, scene.state);
  const Real missing = 0.1 * before.terms[energy_term("external")];
  CHECK(relative_error(closed.terms[energy_term("damping")], missing) < 1e-6);
  CHECK(std::abs(closed.error) < 1e-12);
  scene.step(100);
  CHECK(std::abs(energies(scene.model, scene.state).error) < 1e-9);
}

TEST_CASE("a box that slides to rest turns its energy into friction") {
  Scene scene;
  scene.add_box({-2, -1, -1}, {4, 2, 1}, true);
  const Index box = scene.add_box({-0.5, -0.5, 0}, {1, 1, 1});
  scene.build();
  scene.model.gravity = {0, 0, -10};
  scene.model.contact_damping = 0.1;
  scene.set_interface({{"friction_angle", 0.5}});
  scene.set_motion(box, {1, 0, 0});
  scene.start();
  scene.step(1000);
  const Energies e = energies(scene.model, scene.state);
  CHECK(norm(scene.velocity(8)) < 0.1);
  CHECK(e.terms[energy_term("friction")] > 0.8 * 0.5 * 2500);
  CHECK(std::abs(e.error) < 2e-4);
}

TEST_CASE("energies close where bonds shear off while they are pulled") {
  Scene scene;
  scene.bonded = true;
  scene.add_box({0, 0, 0}, {1, 1, 1}, true);
  const Index box = scene.add_box({0, 0, 1}, {1, 1, 1});
  scene.build();
  scene.set_interface({{"cohesion", 3e5}, {"tensile_strength", 1e7}, {"friction_angle", 0.5}});
  scene.set_motion(box, {1.5, 0, 1});
  scene.start();
  scene.step(60);
  const Energies e = energies(scene.model, scene.state);
  CHECK(on_host(scene.state.quads.broken_shear)[0] == 4);
  CHECK(e.terms[energy_term("fracture")] > 0);
  CHECK(std::abs(e.error) < 1e-3);
}

TEST_CASE("the error is measured against the largest term so far") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.build();
  scene.set_motion(0, {1, 0, 0});
  scene.start();
  scene.step(1);
  State& s = scene.state;
  const Real kinetic = energies(scene.model, s).terms[energy_term("kinetic")];
  CHECK(relative_error(kinetic, 0.5 * 2500) < 1e-15);
  on_host(s.nodes.work_external)[0] += 0.1 * kinetic;  // out of nothing
  CHECK(relative_error(energies(scene.model, s).error, -0.1) < 1e-15);
  s.energy_scale = 10 * kinetic;
  CHECK(relative_error(energies(scene.model, s).error, -0.01) < 1e-15);
  s.energy_scale = 0;
  keep_energy_scale(scene.model, s);
  CHECK(relative_error(s.energy_scale, kinetic) < 1e-12);
}

}  // namespace cdem::test
