// What is fixed and stays as it is needs no computing.
#include "core/nodes/sleep.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

bool lists(const Column<Index>& blocks, Index item) {
  return std::count(blocks.data(), blocks.data() + blocks.size(), item / block_size) > 0;
}

/// Fixed boxes in a row, far apart; the last is free where asked for.
struct Boxes : Scene {
  static constexpr Index count = 64;
  explicit Boxes(bool last_is_free) {
    for (Index b = 0; b < count; ++b)
      add_box({2.0 * b, 0, 0}, {1, 1, 1}, b + 1 < count || !last_is_free);
    build();
    start();
    find_awake(model, state);
  }
};

}  // namespace

TEST_CASE("elements and nodes of which all are fixed sleep") {
  const Boxes all(false);
  CHECK(all.state.hex8.awake.size() == 0);
  const Boxes boxes(true);
  for (Index b = 0; b < Boxes::count; ++b)
    CHECK(lists(boxes.state.hex8.awake, b) == (b >= Boxes::count - block_size));
  const Index last = 8 * (Boxes::count - 1);
  CHECK(on_host(boxes.state.nodes.sleeps)[0]);
  CHECK(on_host(boxes.state.nodes.sleeps)[last - 8]);
  CHECK(!on_host(boxes.state.nodes.sleeps)[last]);
  CHECK(lists(boxes.state.nodes.awake, last));
  CHECK(!lists(boxes.state.nodes.awake, 0));
}

TEST_CASE("elements that share nodes are awake with all of their tile") {
  Boxes boxes(true);
  const auto first = on_host(boxes.state.nodes.element_first);
  for (std::size_t i = 0; i < first.size(); ++i) first[i] *= 2;  // as if each node had two
  find_awake(boxes.model, boxes.state);
  const Index tile = on_host(boxes.state.hex8.tiles.block_first)[1] * block_size;  // the last one
  REQUIRE(tile < Boxes::count - block_size);
  for (Index b = 0; b < Boxes::count; ++b) CHECK(lists(boxes.state.hex8.awake, b) == (b >= tile));
}

TEST_CASE("a fixed node that moves, or carries a load, is awake") {
  Boxes boxes(false);
  CHECK(on_host(boxes.state.nodes.sleeps)[3]);
  for (Index i = 4; i <= boxes.model.node_count; ++i) on_host(boxes.model.load_first)[i] = 1;
  find_awake(boxes.model, boxes.state);
  CHECK(!on_host(boxes.state.nodes.sleeps)[3]);
  CHECK(on_host(boxes.state.nodes.sleeps)[2]);
  boxes.motion(40)[4] = 1;
  find_awake(boxes.model, boxes.state);
  CHECK(!on_host(boxes.state.nodes.sleeps)[40]);
  CHECK(lists(boxes.state.hex8.awake, 5));
}

TEST_CASE("a free block that is bonded to a fixed one pulls at it") {
  Scene scene;
  scene.bonded = true;
  scene.add_box({0, 0, 0}, {1, 1, 1}, true);
  scene.add_box({0, 0, 1}, {1, 1, 1});
  scene.build();
  scene.start();
  find_awake(scene.model, scene.state);
  CHECK(lists(scene.state.quads.awake, 0));
  for (Index i = 0; i < 8; ++i)
    CHECK(bool(on_host(scene.state.nodes.sleeps)[i]) == (scene.position(i).z == 0));
}

TEST_CASE("a node on the last list of contacts stays awake until the next") {
  Boxes boxes(false);
  State& s = boxes.state;
  for (Index& first : on_host(s.search.contact_first)) first = 0;
  const auto contacts = [&](Index of_first) {  // of node 0
    for (Index i = 1; i <= boxes.model.node_count; ++i)
      on_host(s.search.contact_first)[i] = of_first;
    list_awake_nodes(boxes.model, s);
    return lists(s.nodes.awake, 0);
  };
  CHECK(!contacts(0));
  CHECK(contacts(1));
  CHECK(contacts(0));
  CHECK(!contacts(0));
}

}  // namespace cdem::test
