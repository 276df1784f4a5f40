// When the pair list is due, and what is rebuilt with it.
#include "core/contact/pair_list/rebuild.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A box above a fixed one.
struct Falling : Scene {
  Falling() {
    add_box({-1, -1, -1}, {2, 2, 1}, true);
    add_box({-0.5, -0.5, 0.2}, {1, 1, 1});
    build();
    start();
  }
};

}  // namespace

TEST_CASE("the list is due at once in a new state, and when a node has left its skin") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.build();
  CHECK(pair_list_is_due(scene.model, scene.state));
  scene.start();
  CHECK(!pair_list_is_due(scene.model, scene.state));
  const Real skin = on_host(scene.state.search.outer.predicted)[7];
  CHECK(skin > 0);
  scene.motion(0)[0] += 0.9 * skin;
  CHECK(!pair_list_is_due(scene.model, scene.state));
  scene.motion(0)[0] += 0.2 * skin;
  CHECK(pair_list_is_due(scene.model, scene.state));
  CHECK(scene.state.search.outer.skin_exceeded);
}

TEST_CASE("a node that is moved between two runs is noticed by the next step") {
  Falling falling;
  falling.step(3);
  const std::int64_t rebuilds = falling.state.rebuilds;
  falling.step(1);
  CHECK(falling.state.rebuilds == rebuilds);
  falling.motion(8)[0] += 2 * on_host(falling.state.search.outer.predicted)[7];
  falling.step(1);
  CHECK(falling.state.rebuilds == rebuilds + 1);
}

TEST_CASE("with an interval the list is due every so many steps, whatever moves") {
  Falling falling;
  falling.model.rebuild_interval = 10;
  falling.motion(8)[0] += 1;
  CHECK(!pair_list_is_due(falling.model, falling.state));
  falling.state.step += 10;
  CHECK(pair_list_is_due(falling.model, falling.state));
}

TEST_CASE("a rebuild lists the faces that may meet, and expects their springs in the step") {
  Falling falling;
  State& s = falling.state;
  CHECK(s.rebuilds == 1);
  CHECK(s.search.exposed_face.size() == 12);
  CHECK(on_host(s.node_potential)[8] == 0);
  for (Index i = 8; i < 16; ++i) put(falling.motion(i) + 4, Vec{0, 0, -50});
  const Real free_step = s.dt;
  rebuild_pair_list(falling.model, s, {.everything_awake = true});
  CHECK(s.rebuilds == 2);
  CHECK(names_pairs(s.search.outer));
  CHECK(on_host(s.node_potential)[8] > 0);
  CHECK(s.dt < free_step);
  CHECK(s.built_step == s.step);
}

TEST_CASE("faces that may act on each other are listed where a law asks for areas") {
  Falling falling;
  const OuterList& outer = falling.state.search.outer;
  for (Index i = 8; i < 16; ++i) put(falling.motion(i) + 4, Vec{0, 0, -50});
  rebuild_pair_list(falling.model, falling.state, {.everything_awake = true});
  CHECK(outer.acting_first.size() == 0);
  CHECK(outer.faces_acting_on.size() == 0);
  falling.model.interface_traits.ask_area = true;
  rebuild_pair_list(falling.model, falling.state, {.everything_awake = true});
  CHECK(outer.acting_first.size() == falling.state.search.exposed_face.size() + 1);
  CHECK(outer.faces_acting_on.size() > 0);
}

}  // namespace cdem::test
