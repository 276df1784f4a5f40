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
      const Index face = on_host(state.search.exposed_face)[contact.mother / 4];
      list.push_back({on_host(model.face_edges)[4 * face + contact.mother % 4], contact.edge});
    }
    return list;
  }
  bool is_ridge(Index edge) const {
    const Index a = on_host(model.edge_nodes)[2 * edge],
                b = on_host(model.edge_nodes)[2 * edge + 1];
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
    CHECK(on_host(ridges.state.springs.target)[k] == -1);
}

TEST_CASE("ridges that are apart, or parallel, do not touch") {
  CHECK(Ridges(0.001).found().empty());
  CHECK(Ridges(-0.001, 0.01).found().empty());
}

TEST_CASE("contacts are in the order of target face, mother side and target side") {
  const Ridges ridges(-0.001);
  const State& s = ridges.state;
  const auto at = [&](Index c) { return EdgeContact::at(s.edges.contact.data(), c); };
  for (std::size_t x = 0; x < s.search.exposed_face.size(); ++x)
    for (Index c = on_host(s.edges.first)[x]; c + 1 < on_host(s.edges.first)[x + 1]; ++c) {
      CHECK(at(c).face <= at(c + 1).face);
      if (at(c).face == at(c + 1).face) CHECK(at(c).mother <= at(c + 1).mother);
    }
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
    for (std::size_t c = 0; c < 4; ++c) on_host(ridges.state.edges.state)[8 * c + 4] = 2e-3;
    for (Index i = 6; i < 12; ++i)
      put(ridges.motion(i), ridges.position(i) + Vec{0, 0, 1e-3 + gap});
    ridges.step(1);
    CHECK(ridges.found().size() == (gap < 2 * 2e-3 ? 4 : 0));
  }
}

TEST_CASE("pairs of edges know what they hold, and find it anew when contacts were moved") {
  Ridges ridges(-0.001);
  State& s = ridges.state;
  const auto held = [&] {
    std::vector<Index> places;
    for (Index p = 0; p < Index(s.search.inner.near_edges.size()); ++p)
      for (Index side = 0; side < 4; ++side)
        if (const EdgePairs pairs = edge_pairs(s); pairs.held[pairs.place_held(side, p)] >= 0)
          places.push_back(pairs.held[pairs.place_held(side, p)]);
    std::sort(places.begin(), places.end());
    return places;
  };
  ridges.step(1);
  CHECK(s.search.inner.held_known);
  CHECK(held() == std::vector<Index>{0, 1, 2, 3});
  s.search.inner.held_known = false;
  for (Index i = 0; i < Index(s.search.inner.held.size()); ++i)
    on_host(s.search.inner.held)[i] = -1;
  ridges.step(1);
  CHECK(ridges.found().size() == 4);
  for (std::size_t c = 0; c < 4; ++c)
    CHECK(EdgeContact::at(s.edges.contact.data(), c).before == Index(c));
}

TEST_CASE("a ridge may cross any number of edges") {
  // one long ridge, and 80 small ones across it, upside down
  Scene scene;
  scene.add<Wedge6>(
      {{{1, -50, -1}, {-1, -50, -1}, {0, -50, 0}, {1, 50, -1}, {-1, 50, -1}, {0, 50, 0}}});
  for (Index k = 0; k < 80; ++k) {
    const Real y = k - 40, w = 0.3, low = -0.001;
    scene.add<Wedge6>({{{-2, y + w, 1 + low},
                        {-2, y - w, 1 + low},
                        {-2, y, low},
                        {2, y + w, 1 + low},
                        {2, y - w, 1 + low},
                        {2, y, low}}});
  }
  scene.build();
  scene.start();
  scene.step(2);
  CHECK(scene.state.edges.contact.size() / 4 == 80 * 4);
  for (std::size_t c = 0; c < 80 * 4; ++c)
    CHECK(EdgeContact::at(scene.state.edges.contact.data(), c).before == Index(c));
}

TEST_CASE("edges are judged in lanes as one by one, and as sides") {
  const Ridges ridges(-0.001);
  State& s = const_cast<State&>(ridges.state);
  const TouchingEdges search = touching_edges(ridges.model, s);
  struct Sides {
    Index mother, target;
  };
  std::vector<Sides> all;
  const Index exposed = Index(s.search.exposed_face.size());
  for (Index m = 0; m < exposed; ++m)
    for (Index t = 0; t < exposed; ++t)
      for (Index k = 0; k < on_host(s.search.exposed)[m].count(); ++k)
        for (Index j = 0; j < on_host(s.search.exposed)[t].count(); ++j)
          if (m / 5 != t / 5) all.push_back({4 * m + k, 4 * t + j});
  const auto edges_of = [&](const Sides& sides) {
    const ExposedRow &m = on_host(s.search.exposed)[sides.mother / 4],
                     &t = on_host(s.search.exposed)[sides.target / 4];
    return TwoEdges<Index>{.end = {{m.corner[sides.mother % 4], m.end(sides.mother % 4)},
                                   {t.corner[sides.target % 4], t.end(sides.target % 4)}},
                           .side = {{sides.mother, sides.mother}, {sides.target, sides.target}},
                           .code = EdgeWays::code_of(0xff, 0, 0, 0),
                           .before = {-1, -1, -1, -1}};
  };
  Index touching = 0;
  for (std::size_t from = 0; from + lanes <= all.size(); from += lanes) {
    TwoEdges<IndexPack> pack;
    for (Index lane = 0; lane < lanes; ++lane) {
      const TwoEdges<Index> one = edges_of(all[from + lane]);
      for (Index e = 0; e < 2; ++e)
        for (Index i = 0; i < 2; ++i) {
          pack.end[e][i].id[lane] = one.end[e][i];
          pack.side[e][i].id[lane] = one.side[e][i];
          pack.before[2 * e + i].id[lane] = -1;
        }
      pack.code.id[lane] = one.code;
    }
    const Touching in_lanes = search.judge(pack);
    for (Index lane = 0; lane < lanes; ++lane) {
      const Sides& sides = all[from + lane];
      const Touching alone = search.judge(edges_of(sides));
      for (Index way = 0; way < EdgeWays::count; ++way) {
        CHECK((in_lanes.touches[way] >> lane & 1) == alone.touches[way]);
        CHECK((in_lanes.too_deep[way] >> lane & 1) == alone.too_deep[way]);
        const bool reverse = EdgeWays::is_reverse(way);
        CHECK(bool(alone.touches[way]) == search.touch(reverse ? sides.target : sides.mother,
                                                       reverse ? sides.mother : sides.target, 0,
                                                       -1));
      }
      touching += alone.touches[0];
    }
  }
  CHECK(touching == 4);
}

}  // namespace cdem::test
