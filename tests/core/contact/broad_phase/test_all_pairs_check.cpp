// The search of all pairs notices what the lists miss.
#include "core/contact/broad_phase/all_pairs_check.hpp"
#include "core/contact/narrow_phase/narrow_phase.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

TEST_CASE("a contact that is dropped counts as missed, one that is made up too") {
  Scene scene;
  scene.add_box({-1, -1, -1}, {2, 2, 1}, true);
  const Index box = scene.add_box({-0.5, -0.5, 0}, {1, 1, 1});
  scene.build();
  scene.set_motion(box, {0, 0, -0.1});
  scene.model.check_search = true;
  scene.start();
  scene.step(3);
  Column<Index>& target = scene.state.springs.target;
  check_against_all_pairs(scene.model, scene.state);
  CHECK(scene.state.missed == 0);
  std::size_t held = 0, idle = 0;
  for (std::size_t slot = 0; slot < target.size(); ++slot)
    (on_host(target)[slot] >= 0 ? held : idle) = slot;
  REQUIRE(on_host(target)[held] >= 0);
  const Index kept = on_host(target)[held];
  on_host(target)[held] = -1;
  check_against_all_pairs(scene.model, scene.state);
  CHECK(scene.state.missed == 1);
  on_host(target)[held] = kept;
  on_host(target)[idle] = kept;
  check_against_all_pairs(scene.model, scene.state);
  CHECK(scene.state.missed == 2);
  scene.model.check_search = false;
  check_against_all_pairs(scene.model, scene.state);
  CHECK(scene.state.missed == 2);
}

}  // namespace cdem::test
