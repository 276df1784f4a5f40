// The time loop: when it ends, and that its split into runs changes nothing.
#include "core/diagnostics/energy.hpp"
#include "core/run/run.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A box that falls onto a fixed one, and a tet that hits it from the side.
void fill(Scene& scene, Random& random) {
  scene.add_box({-2, -2, -1}, {4, 4, 1}, true);
  const Index box = scene.add_box({-0.5, -0.5, 0.02}, {1, 1, 1});
  const Index tet = scene.add_tet(random, {1.5, 0.1, 0.6}, 0.8);
  scene.build();
  scene.model.gravity = {0, 0, -9.81};
  scene.model.rules.lifted = 0;
  scene.set_interface({{"friction_angle", 0.5}});
  scene.set_motion(box, {0.5, 0, -1}, {0.2, 0.3, 0.1});
  scene.set_motion(tet, {-3, 0, 0}, {1, 2, 3});
  scene.model.check_search = true;
  scene.start();
}

}  // namespace

TEST_CASE("a run goes so many steps, or to a time") {
  Random random(1);
  Scene scene;
  fill(scene, random);
  const Report steps = run(scene.model, scene.state, {.steps = 7});
  CHECK(steps.outcome == Outcome::steps_done);
  CHECK(scene.state.step == 7);
  const Real end = scene.state.time + 0.01;
  const Report time = run(scene.model, scene.state, {.steps = 100000, .end_time = end});
  CHECK(time.outcome == Outcome::time_reached);
  CHECK(scene.state.time >= end);
  CHECK(scene.state.time < end + scene.state.dt);
}

TEST_CASE("energies of a collision close") {
  Random random(1);
  Scene scene;
  fill(scene, random);
  const Report report = run(scene.model, scene.state, {.steps = 2000});
  CHECK(report.outcome == Outcome::steps_done);
  const Energies e = energies(scene.model, scene.state);
  CHECK(e.terms[energy_term("friction")] > 0);
  CHECK(std::abs(e.error) < 1e-2);
}

}  // namespace cdem::test
