// How far the forces are from balance.
#include "core/diagnostics/unbalance.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

TEST_CASE("a body in free fall is out of balance by its whole weight") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.build();
  scene.model.gravity = {0, 0, -10};
  scene.start();
  scene.step(1);
  CHECK(relative_error(unbalance_ratio(scene.model, scene.state), 1) < 1e-12);
}

TEST_CASE("what acts on supports needs no balance") {
  Scene scene;
  scene.add_box({0, 0, 0}, {10, 10, 10}, true);
  scene.add_box({0, 0, 20}, {1, 1, 1});
  scene.build();
  scene.model.gravity = {0, 0, -10};
  scene.start();
  scene.step(1);
  CHECK(relative_error(unbalance_ratio(scene.model, scene.state), 1) < 5e-11);
  for (Real& force : on_host(scene.state.nodes.unbalance)) force = 0;
  CHECK(unbalance_ratio(scene.model, scene.state) == 0);
}

}  // namespace cdem::test
