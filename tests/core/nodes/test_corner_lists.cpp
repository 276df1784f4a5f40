// Which rows of forces belong to each node.
#include "core/nodes/corner_lists.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Two boxes on each other, bonded.
struct Stack : Scene {
  Stack() {
    bonded = true;
    add_box({0, 0, 0}, {1, 1, 1});
    add_box({0, 0, 1}, {1, 1, 1});
    build();
    set_interface({{"cohesion", 1e9}, {"tensile_strength", 1e9}, {"friction_angle", 0.5}});
    start();
  }
};

}  // namespace

TEST_CASE("a node lists the row of its pair with opposite signs") {
  const Stack stack;
  const Column<Index>&first = stack.state.nodes.corner_first, &corner = stack.state.nodes.corner;
  Index owned = 0, opposite = 0;
  for (Index i = 0; i < stack.model.node_count; ++i) {
    const bool at_bond = stack.position(i).z == 1;
    CHECK(on_host(first)[i + 1] - on_host(first)[i] == (at_bond ? 1 : 0));
    if (!at_bond) continue;
    const Index row = on_host(corner)[on_host(first)[i]];
    (row < 0 ? opposite : owned) += 1;
    CHECK((row < 0 ? ~row : row) >= stack.model.quads.corner_first);
  }
  CHECK(owned == 4);
  CHECK(opposite == 4);
}

TEST_CASE("rows of a released pair are on no list") {
  Stack stack;
  on_host(stack.state.quads.status)[0] = 0;
  list_corners(stack.model, stack.state);
  const Column<Index>& first = stack.state.nodes.corner_first;
  for (Index i = 0; i < stack.model.node_count; ++i)
    CHECK(on_host(first)[i + 1] - on_host(first)[i] == 0);
}

TEST_CASE("a node lists the contact rows of its faces that are not idle") {
  Stack stack;
  const Index exposed = Index(stack.state.search.exposed_face.size());
  CHECK(exposed == 10);
  for (Index x = 0; x < exposed; ++x) on_host(stack.state.search.outer.face_listed)[x] = x % 2;
  list_contact_corners(stack.model, stack.state);
  const Column<Index>&first = stack.state.search.contact_first,
        &corner = stack.state.search.contact_corner;
  Index listed = 0;
  for (Index i = 0; i < stack.model.node_count; ++i)
    for (Index c = on_host(first)[i]; c < on_host(first)[i + 1]; ++c, ++listed) {
      const Index x = on_host(corner)[c] / 4, face = on_host(stack.state.search.exposed_face)[x];
      CHECK(x % 2 == 1);
      CHECK(on_host(stack.model.face_nodes)[4 * face + on_host(corner)[c] % 4] == i);
    }
  CHECK(listed == 4 * exposed / 2);
}

}  // namespace cdem::test
