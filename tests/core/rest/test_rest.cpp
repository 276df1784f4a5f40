// A solve finds the rest that relaxation finds, and books the energies of the way there.
#include "core/diagnostics/energy.hpp"
#include "core/rest/rest.hpp"
#include "tests/core/rest/wall.hpp"

namespace cdem::test {

namespace {

/// The largest distance between the nodes of two scenes, by the largest displacement.
Real difference(Scene& a, Scene& b, const std::vector<Vec>& start) {
  Real most = 0, moved = 0;
  for (Index i = 0; i < a.model.node_count; ++i) {
    most = std::max(most, distance(a.position(i), b.position(i)));
    moved = std::max(moved, distance(a.position(i), start[i]));
  }
  return most / moved;
}

void check_same_rest(Scene& solved, Scene& relaxed) {
  std::vector<Vec> start;
  for (Index i = 0; i < solved.model.node_count; ++i) start.push_back(solved.position(i));
  const RestFound found = solve_for_rest(solved.model, solved.state, 1e-8);
  CHECK(found.before == doctest::Approx(1).epsilon(1e-6));
  CHECK(found.after < 1e-8);
  const Goal goal{.steps = 100000, .unbalance_limit = 1e-8, .relaxation = Relaxation::adaptive};
  CHECK(run(relaxed.model, relaxed.state, goal).outcome == Outcome::converged);
  CHECK(difference(solved, relaxed, start) < 1e-5);
  // the next sample opens the ledger of one and closes that of the other
  run(solved.model, solved.state, {.steps = 20});
  const Energies e = energies(solved.model, solved.state);
  CHECK(std::abs(e.start) < 1e-6 * e.terms[energy_term("external")]);
  CHECK(std::abs(e.error) < 1e-9);
  CHECK(e.terms[energy_term("damping")] ==
        doctest::Approx(0.5 * e.terms[energy_term("external")]).epsilon(1e-2));
}

}  // namespace

TEST_CASE("bonded boxes under their weight") {
  Wall solved, relaxed;
  check_same_rest(solved, relaxed);
}

TEST_CASE("a round that needs more iterations moves nothing") {
  Wall wall;
  const Vec before = wall.position(0);
  const RestFound found = solve_for_rest(wall.model, wall.state, 1e-8, 1);
  CHECK(found.rounds == 0);
  CHECK(found.after == found.before);
  CHECK(distance(before, wall.position(0)) == 0);
}

TEST_CASE("a box that lies on another one") {
  const auto fill = [](Scene& scene) {
    scene.add_box({-2, -2, -1}, {4, 4, 1}, true);
    scene.add_box({-0.5, -0.5, 0}, {1, 1, 1});
    scene.build();
    scene.model.gravity = {0, 0, -9.81};
    scene.set_interface({{"friction_angle", 0.5}});
    scene.start();
    scene.step(20);  // a box that has not begun to touch is held by nothing
    for (Index i = 0; i < scene.model.node_count; ++i) put(scene.motion(i) + 4, Vec{0, 0, 0});
  };
  Scene scene;
  fill(scene);
  const RestFound found = solve_for_rest(scene.model, scene.state, 1e-8);
  CHECK(found.rounds > 0);
  CHECK(found.after < 1e-8);
}

TEST_CASE("what nothing holds is left as it is") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.build();
  scene.model.gravity = {0, 0, -9.81};
  scene.start();
  const Vec before = scene.position(0);
  const RestFound found = solve_for_rest(scene.model, scene.state, 1e-8);
  CHECK(found.rounds == 0);
  CHECK(found.after == doctest::Approx(1));
  CHECK(distance(before, scene.position(0)) == 0);
}

}  // namespace cdem::test
