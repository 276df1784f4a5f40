// The lists name every pair that comes into contact before they are made again.
#include <algorithm>

#include "core/contact/broad_phase/edge_edge_pairs.hpp"
#include "core/contact/broad_phase/pair_search.hpp"
#include "core/contact/broad_phase/vertex_face_pairs.hpp"
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

/// Blocks of all shapes that overlap and fly, around a plate that is larger than all of them.
struct Throw : Scene {
  explicit Throw(std::uint64_t seed) {
    Random random(seed);
    add_box({-2, -2, -0.4}, {4, 4, 0.5}, true);
    for (Index i = 0; i < 12; ++i) {
      const Vec at = random.vector(0.8) + Vec{0, 0, 0.8};
      if (i % 4 == 0) add_tet(random, at, random.between(0.3, 1));
      if (i % 4 == 1) add<Hex8>(thrown(Reference<Hex8>::corners(), random, at));
      if (i % 4 == 2) add<Wedge6>(thrown(Reference<Wedge6>::corners(), random, at));
      if (i % 4 == 3) add<Pyramid5>(thrown(Reference<Pyramid5>::corners(), random, at));
    }
    build();
    set_interface({{"friction_angle", 0.3}});
    for (Index b = 1; b < 13; ++b) set_motion(b, random.vector(2), random.vector(2));
    start();
  }

 private:
  template <class Corners>
  static Corners thrown(Corners corners, Random& random, const Vec& at) {
    const Mat turn = random.between(0.2, 0.5) * random.rotation();
    for (Vec& c : corners) c = at + turn * c;
    return corners;
  }
};

/// The lists of a search, made pair by pair from all patches.
struct PairByPair {
  std::vector<PatchPair> pairs;
  std::vector<VertexFaceItem> vertex_faces;
  std::vector<EdgeItem> edges;

  PairByPair(const PairContext& f, const PairSearch& search) {
    const Index count = Index(search.patches.size());
    for (Index p = 0; p < count; ++p)
      for (Index q = 0; q < count && f.patches[p].movable; ++q) {
        const Patch &a = f.patches[p], &b = f.patches[q];
        if ((q > p || !b.movable) && a.block != b.block && a.box.overlaps(b.box))
          add(f, search.moving.data(), p, q);
      }
  }

 private:
  void add(const PairContext& f, const MovingEdge* moving, Index p, Index q) {
    PatchPair pair{.one = p, .other = q, .edge = {}, .vertex = {}, .meets = 0, .listed = {}};
    if (!MayMeet{f}(pair) || !FindMeetingParts{f, false}(pair)) return;
    const One place{Index(pairs.size())};
    pairs.push_back(pair);
    ListVertexFaces{f, pairs.data()}.visit(place, [&](VertexFaceItem item) {
      if (VertexMayTouch{f, pairs.data()}(item)) vertex_faces.push_back(item);
    });
    ListEdgesOfPatches{f, pairs.data(), moving}.visit(place, [&](EdgeItem item) {
      if (EdgesMayTouch{f, pairs.data(), moving}(item)) edges.push_back(item);
    });
  }
};

template <class Item>
bool are_same(const std::vector<Item>& one, const Column<Item>& other) {
  const auto items = on_host(other);
  return std::equal(one.begin(), one.end(), items.begin(), items.end());
}

}  // namespace

TEST_CASE("passes over lists, in batches or not, find what a search of each pair by itself does") {
  std::size_t pairs = 0, vertices = 0, edges = 0, batches = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Throw blocks(seed);
    for (int k = 0; k < 3; ++k) {
      PairSearch search;
      if (k > 0) search.at_once = k;  // in batches of a patch or two, and of 16 or 32 pairs
      search_pairs(blocks.model, blocks.state, search);
      const PairContext f = on_host(pair_context(blocks.model, blocks.state, search));
      const PairByPair expected(f, search);
      CHECK(are_same(expected.pairs, search.pairs));
      CHECK(are_same(expected.vertex_faces, search.vertex_faces));
      CHECK(are_same(expected.edges, search.edges));
      pairs += expected.pairs.size(), vertices += expected.vertex_faces.size();
      edges += expected.edges.size();
      batches = std::max(batches, expected.pairs.size() / (16 * std::size_t(search.at_once)));
      blocks.step(20);
    }
  }
  CHECK(pairs > 1000);
  CHECK(vertices > 1000);
  CHECK(edges > 500);
  CHECK(batches > 1);
}

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
    CHECK(names_pairs(scene.state.search.outer) == approach);
  }
}

TEST_CASE("blocks that cannot move are not searched for contacts with each other") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1}, true);
  scene.add_box({0, 0, 1}, {1, 1, 1}, true);
  scene.build();
  scene.start();
  CHECK(!names_pairs(scene.state.search.outer));
}

}  // namespace cdem::test
