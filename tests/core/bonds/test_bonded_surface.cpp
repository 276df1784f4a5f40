// What intact bonds join is one body: its points, and the surface around them.
#include "core/bonds/bonded_surface.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Unit boxes, those beside each other bonded.
struct Boxes : Scene {
  explicit Boxes(const std::vector<Vec>& low) {
    bonded = true;
    for (const Vec& at : low) add_box(at, {1, 1, 1});
    build();
    set_interface({{"cohesion", 1e9}, {"tensile_strength", 1e9}});
    start();
  }
  /// The exposed face of a block that has a normal.
  Index exposed(Index block, const Vec& normal) const {
    for (Index f = 0; f < model.face_count; ++f) {
      const Index* n = model.face_nodes.data() + 4 * f;
      const Vec out = unit(cross(position(n[1]) - position(n[0]), position(n[2]) - position(n[1])));
      if (on_host(model.face_block)[f] == block && distance(out, normal) < 1e-9)
        return on_host(state.search.face_exposed)[f];
    }
    return -1;
  }
  /// Faces beyond the sides of an exposed one.
  std::vector<Index> beyond(Index place) const {
    const Index* across = state.search.across.data() + 4 * place;
    std::vector<Index> places;
    for (Index k = 0; k < 4; ++k)
      places.push_back(across[k] < 0 ? -1 : on_host(state.search.face_exposed)[across[k]]);
    return places;
  }
  void break_bonds(Index pair) {
    for (Index k = 0; k < 4; ++k)
      on_host(state.quads.bond)[k * model.quads.point_stride + pair] = 0;
  }
};

/// Two boxes on each other.
struct Stack : Boxes {
  Stack() : Boxes({{0, 0, 0}, {0, 0, 1}}) {}
};

bool has(const std::vector<Index>& list, Index value) {
  return std::count(list.begin(), list.end(), value) > 0;
}

}  // namespace

TEST_CASE("nodes that intact bonds hold together share a label") {
  Stack stack;
  for (Index i = 0; i < 16; ++i)
    for (Index j = 0; j < i; ++j)
      CHECK((on_host(stack.state.nodes.bonded_node)[i] ==
             on_host(stack.state.nodes.bonded_node)[j]) ==
            (distance(stack.position(i), stack.position(j)) == 0));
}

TEST_CASE("nodes of blocks that bonds join, directly or through others, are of one body") {
  Scene chain;
  chain.bonded = true;
  for (int k = 0; k < 3; ++k) chain.add_box({0, 0, Real(k)}, {1, 1, 1});
  chain.add_box({5, 0, 0}, {1, 1, 1});
  chain.build();
  chain.set_interface({{"cohesion", 1e9}, {"tensile_strength", 1e9}});
  chain.start();
  State& s = chain.state;
  for (Index i = 0; i < 32; ++i) CHECK(on_host(s.nodes.body)[i] == (i < 24 ? 0 : 24));
  on_host(s.quads.status)[1] = Flag(PairStatus::released);
  join_surfaces(chain.model, s, true);
  for (Index i = 0; i < 32; ++i) CHECK(on_host(s.nodes.body)[i] == (i < 16 ? 0 : i < 24 ? 16 : 24));
}

TEST_CASE("beyond a side at a bond lies the face of the other block, flush with it") {
  const Stack stack;
  for (const Vec& side : {Vec{1, 0, 0}, Vec{-1, 0, 0}, Vec{0, 1, 0}, Vec{0, -1, 0}}) {
    const Index lower = stack.exposed(0, side), upper = stack.exposed(1, side);
    REQUIRE(lower >= 0);
    REQUIRE(upper >= 0);
    CHECK(has(stack.beyond(lower), upper));
    CHECK(has(stack.beyond(upper), lower));
    CHECK(has(stack.beyond(lower), stack.exposed(0, {0, 0, -1})));
    CHECK(!has(stack.beyond(lower), -1));
  }
}

TEST_CASE(
    "the face beyond a side is found through all bodies around an edge, up to a broken bond") {
  Boxes ring({{0, 0, 0}, {-1, 0, 0}, {-1, -1, 0}});  // the fourth is missing
  const Index begin = ring.exposed(0, {0, -1, 0}), end = ring.exposed(2, {1, 0, 0});
  CHECK(has(ring.beyond(begin), end));
  CHECK(has(ring.beyond(end), begin));
  ring.break_bonds(1);
  join_surfaces(ring.model, ring.state, false);
  CHECK(!has(ring.beyond(begin), end));
  CHECK(!has(ring.beyond(end), begin));
  CHECK(has(ring.beyond(begin), -1));  // a face that is not exposed yet
}

TEST_CASE("beyond a side of a triangle is another face of it, and it has no fourth side") {
  Scene tet;
  Random random(1);
  tet.add_tet(random, {0, 0, 0}, 1);
  tet.build();
  tet.set_interface({});
  tet.start();
  for (Index x = 0; x < 4; ++x) {
    const Index* const across = on_host(tet.state.search.across).data() + 4 * x;
    std::vector<Index> faces{x, across[0], across[1], across[2]};
    std::sort(faces.begin(), faces.end());
    CHECK(faces == std::vector<Index>{0, 1, 2, 3});
    CHECK(across[3] == -1);
  }
}

TEST_CASE("edges that leave a point are those of all nodes that are bonded there, each once") {
  const Stack stack;
  const Column<Index>&first = stack.state.search.edge_star_first,
        &star = stack.state.search.edge_star;
  for (Index i = 0; i < 16; ++i) {
    const Index label = on_host(stack.state.nodes.bonded_node)[i];
    const Vec x = stack.position(i);
    Index ends = 0;
    for (Index r = on_host(first)[label]; r < on_host(first)[label + 1]; ++r, ++ends)
      CHECK(std::abs(norm(stack.position(on_host(star)[r]) - x) - 1) < 1e-15);
    CHECK(ends == (x.z == 1 ? 4 : 3));
  }
}

TEST_CASE("where the bond is broken the nodes part") {
  Stack stack;
  stack.break_bonds(0);
  join_surfaces(stack.model, stack.state, false);
  for (Index i = 0; i < 16; ++i) CHECK(on_host(stack.state.nodes.bonded_node)[i] == i);
}

}  // namespace cdem::test
