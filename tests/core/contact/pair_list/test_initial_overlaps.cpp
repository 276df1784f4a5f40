// Blocks that overlap at the start begin free of stress.
#include "core/contact/pair_list/initial_overlaps.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A box that stands so deep in another.
struct Sunk : Scene {
  explicit Sunk(Real depth) {
    add_box({-1, -1, -1}, {2, 2, 1}, true);
    add_box({-0.5, -0.5, -depth}, {1, 1, 1});
    build();
    start();
  }
};

}  // namespace

TEST_CASE("overlaps are counted, and the springs there are free of stress at their depth") {
  Sunk sunk(0.05);
  const InitialOverlaps found = adopt_overlaps(sunk.model, sunk.state);
  // four vertices, each through the face that looks down
  CHECK(found.count == 4);
  CHECK(relative_error(found.deepest, 0.05) < 1e-14);
  CHECK(on_host(sunk.model.face_block)[found.face] == 1);
  for (int n = 0; n < 20; ++n) sunk.step(1);
  for (Index i = 8; i < 16; ++i) CHECK(norm(sunk.velocity(i)) < 3e-13);
}

TEST_CASE("blocks that touch, or are apart, do not overlap") {
  for (const Real depth : {0.0, -0.1}) {
    Sunk sunk(depth);
    CHECK(adopt_overlaps(sunk.model, sunk.state).count == 0);
  }
}

}  // namespace cdem::test
