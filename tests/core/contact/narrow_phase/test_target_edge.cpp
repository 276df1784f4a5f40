// Which edges a semi-edge crosses, Eq. 10-12.
#include "core/contact/narrow_phase/target_edge.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Two ridges (wedges) that cross at right angles, the upper one upside down, `gap` apart.
struct Ridges : Scene {
  explicit Ridges(Real gap, Real angle = 1.5) {
    // triangles at the ends, the ridge from node 2 to node 5
    add<Wedge6>({{{1, -2, -1}, {-1, -2, -1}, {0, -2, 0}, {1, 2, -1}, {-1, 2, -1}, {0, 2, 0}}});
    const Real s = std::sin(angle), c = std::cos(angle);
    const auto turned = [&](Real x, Real y, Real z) {
      return Vec{c * x - s * y, s * x + c * y, z};
    };
    add<Wedge6>({{turned(-1, -2, 1 + gap), turned(1, -2, 1 + gap), turned(0, -2, gap),
                  turned(-1, 2, 1 + gap), turned(1, 2, 1 + gap), turned(0, 2, gap)}});
    build();
    start();
    step(1);
  }
  struct Found {
    Index mother, target;  // edges
  };
  std::vector<Found> found() const {
    std::vector<Found> list;
    for (std::size_t c = 0; c < state.edges.contact.size() / 4; ++c) {
      const EdgeContact contact = EdgeContact::at(state.edges.contact.data(), c);
      const Index face = state.search.exposed_face[contact.mother / 4];
      list.push_back({model.face_edges[4 * face + contact.mother % 4], contact.edge});
    }
    return list;
  }
  bool is_ridge(Index edge) const {
    const Index a = model.edge_nodes[2 * edge], b = model.edge_nodes[2 * edge + 1];
    return b == a + 3 && a % 6 == 2;
  }
};

}  // namespace

TEST_CASE("ridges that cross touch each other: two semi-edges of either block") {
  const Ridges ridges(-0.001);
  const auto found = ridges.found();
  CHECK(found.size() == 4);
  for (const auto& contact : found) {
    CHECK(ridges.is_ridge(contact.mother));
    CHECK(ridges.is_ridge(contact.target));
    CHECK(contact.mother != contact.target);
  }
  for (std::size_t k = 0; k < ridges.state.springs.target.size(); ++k)
    CHECK(ridges.state.springs.target[k] == -1);
}

TEST_CASE("ridges that are apart, or parallel, do not touch") {
  CHECK(Ridges(0.001).found().empty());
  CHECK(Ridges(-0.001, 0.01).found().empty());
}

TEST_CASE("a found contact is read back, and sorted by target face, mother side, target side") {
  Index rows[6];
  FoundEdge{4, 9, 2}.store(rows, 1);
  const FoundEdge back = FoundEdge::at(rows, 1);
  CHECK(back.mother == 4);
  CHECK(back.target == 9);
  CHECK(back.before == 2);
  CHECK(FoundEdge{5, 8, -1}.is_before({4, 12, -1}));
  CHECK(FoundEdge{4, 9, -1}.is_before({5, 8, -1}));
  CHECK(FoundEdge{4, 8, -1}.is_before({4, 9, -1}));
  CHECK(!FoundEdge{4, 9, -1}.is_before({4, 9, -1}));
}

TEST_CASE("contacts go on from step to step, each with its own history") {
  Ridges ridges(-0.001);
  for (int k = 0; k < 5; ++k) {
    ridges.step(1);
    for (std::size_t c = 0; c < ridges.state.edges.contact.size() / 4; ++c)
      CHECK(EdgeContact::at(ridges.state.edges.contact.data(), c).before == Index(c));
  }
}

TEST_CASE(
    "ridges that have dilated are kept at a gap, to twice the height to which they have risen") {
  for (const Real gap : {1e-3, 5e-3}) {
    Ridges ridges(-0.001);
    ridges.model.rules.lifted = 0.01;
    for (std::size_t c = 0; c < 4; ++c) ridges.state.edges.state[8 * c + 4] = 2e-3;
    for (Index i = 6; i < 12; ++i)
      put(ridges.motion(i), ridges.position(i) + Vec{0, 0, 1e-3 + gap});
    ridges.step(1);
    CHECK(ridges.found().size() == (gap < 2 * 2e-3 ? 4 : 0));
  }
}

TEST_CASE("sides are tested in lanes as one by one") {
  const Ridges ridges(-0.001);
  State& s = const_cast<State&>(ridges.state);
  const ResolveTargetEdges search = edge_search(ridges.model, s);
  Random random(1);
  Index touching = 0;
  const Index exposed = Index(s.search.exposed_face.size());
  std::vector<TwoSides<Index>> all;
  for (Index m = 0; m < exposed; ++m)
    for (Index t = 0; t < exposed; ++t)
      for (Index k = 0; k < s.search.exposed[m].count(); ++k)
        for (Index j = 0; j < s.search.exposed[t].count(); ++j)
          if (m / 5 != t / 5) all.push_back({m, t, SidePair{k, j, 0}.code(), -1});
  for (std::size_t from = 0; from + lanes <= all.size(); from += lanes) {
    TwoSides<IndexPack> pack;
    for (Index j = 0; j < lanes; ++j) {
      pack.m.id[j] = all[from + j].m, pack.t.id[j] = all[from + j].t;
      pack.sides.id[j] = all[from + j].sides, pack.before.id[j] = -1;
    }
    const auto in_lanes = search.test(pack);
    for (Index j = 0; j < lanes; ++j) {
      const auto alone = search.test(all[from + j]);
      CHECK(holds(in_lanes.touches, j) == alone.touches);
      CHECK(holds(in_lanes.too_deep, j) == alone.too_deep);
      touching += alone.touches;
    }
  }
  CHECK(touching == 4);
}

}  // namespace cdem::test
