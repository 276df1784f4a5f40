// The lists name every pair that comes into contact before they are made again.
#include "core/contact/broad_phase/pair_search.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A heap of tets and boxes that fly into each other and spin, checked in every step against a
/// search of all pairs.
struct Rubble : Scene {
  explicit Rubble(std::uint64_t seed) {
    Random random(seed);
    for (Index i = 0; i < 8; ++i) {
      const Vec at{Real(i % 2), Real(i / 2 % 2), Real(i / 4)};
      if (i % 3 == 0)
        add_box(at - Vec{0.3, 0.3, 0.3}, {0.6, 0.6, 0.6});
      else
        add_tet(random, at, 0.7);
    }
    build();
    set_interface({{"friction_angle", 0.3}});
    const Vec middle{0.5, 0.5, 0.5};
    for (Index b = 0; b < 8; ++b) {
      const Vec at{Real(b % 2), Real(b / 2 % 2), Real(b / 4)};
      set_motion(b, Real(3) * (middle - at) + random.vector(0.5), random.vector(4));
    }
    model.check_search = true;
    start();
  }
  Index contacts() const {
    Index count = Index(state.edges.contact.size() / 4);
    for (std::size_t k = 0; k < state.springs.target.size(); ++k)
      count += on_host(state.springs.target)[k] >= 0;
    return count;
  }
};

}  // namespace

TEST_CASE("no contact of tumbling blocks is missed, by vertices or by edges") {
  Index springs = 0, edges = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    Rubble rubble(seed);
    for (int k = 0; k < 40; ++k) {
      const Report report = run(rubble.model, rubble.state, {.steps = 10});
      REQUIRE(report.outcome == Outcome::steps_done);
      edges += Index(rubble.state.edges.contact.size() / 4);
      springs += rubble.contacts() - Index(rubble.state.edges.contact.size() / 4);
    }
    CHECK(rubble.state.missed == 0);
    CHECK(rubble.state.rebuilds > 3);
    CHECK(rubble.state.rebuilds < 100);
  }
  CHECK(springs > 100);
  CHECK(edges > 30);
}

TEST_CASE("blocks that fly apart are on no list, those on their way to each other are") {
  for (const bool approach : {false, true}) {
    Random random(4);
    Scene scene;
    scene.add_tet(random, {0, 0, 0}, 1);
    scene.add_tet(random, {1.5, 0, 0}, 1);
    scene.build();
    scene.set_motion(0, {approach ? 20.0 : -20.0, 0, 0});
    scene.start();
    while (scene.state.rebuilds < 2) scene.step(1);  // the first list looks no step ahead
    CHECK((scene.state.search.outer.faces_acting_on.size() > 0) == approach);
  }
}

TEST_CASE("blocks that cannot move are not searched for contacts with each other") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1}, true);
  scene.add_box({0, 0, 1}, {1, 1, 1}, true);
  scene.build();
  scene.start();
  CHECK(scene.state.search.outer.faces_acting_on.size() == 0);
}

}  // namespace cdem::test
