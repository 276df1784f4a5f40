// What a plane holds apart comes into no contact while the lists hold.
#include "core/contact/broad_phase/pair_search.hpp"
#include "core/contact/broad_phase/separating_planes.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/contact/pair_list/outer_faces.hpp"
#include "core/contact/pair_list/rebuild.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Two convex blocks that move past or into each other, and the lists of them.
struct TwoBlocks : Scene {
  Vec velocity_of[2];
  PairSearch lists;

  explicit TwoBlocks(Random& random) {
    const Vec apart = random.between(0.6, 1.6) * random.direction();
    for (Index b = 0; b < 2; ++b) {
      const Vec at = b == 0 ? Vec{0, 0, 0} : apart;
      if (random.below(2)) {
        add_tet(random, at, 1);
      } else {
        std::array<Vec, 8> x = Reference<Hex8>::corners();
        const Mat turn = random.rotation() * random.stretch(0.3);
        for (Vec& c : x) c = at + Real(0.35) * (turn * c);
        if (dot(cross(x[1] - x[0], x[3] - x[0]), x[4] - x[0]) < 0)
          for (Vec& c : x) c = at - (c - at);
        add<Hex8>(x);
      }
    }
    build();
    for (Index b = 0; b < 2; ++b) {
      velocity_of[b] = random.vector(1);
      set_motion(b, velocity_of[b]);
    }
    state.dt = 1e-3;  // the lists look 0.2 s ahead
    rebuild_pair_list(model, state, {.everything_awake = true});
    // the search is made again with room for nothing but the motion
    search_pairs(model, state, lists);
  }
  Vec at(Index node, Real time) const {
    return position(node) + time * velocity_of[on_host(model.node_block)[node]];
  }
  /// How far a point is outside of a block at a time: its largest gap to one of its faces  [m].
  Real outside_of(Index block, const Vec& point, Real time) const {
    Real largest = -1e300;
    for (Index f = 0; f < model.face_count; ++f) {
      if (on_host(model.face_block)[f] != block) continue;
      const Index* n = model.face_nodes.data() + 4 * f;
      const Vec a = at(n[0], time), b = at(n[1], time), c = at(n[2], time);
      largest = std::max(largest, dot(unit(cross(b - a, c - a)), point - a));
    }
    return largest;
  }
};

}  // namespace

TEST_CASE("a vertex or an edge that is separated stays outside of the other block") {
  Random random(1);
  Index separated_vertices = 0, near_vertices = 0, inside_vertices = 0, separated_edges = 0;
  for (int k = 0; k < 200; ++k) {
    const TwoBlocks blocks(random);
    const PairSearch& lists = blocks.lists;
    const PairContext context = on_host(pair_context(blocks.model, blocks.state, lists));
    REQUIRE(lists.patches.size() == 2);
    const SeparatedParts separated(context, context.patches[0], context.patches[1]);
    const Real horizon = blocks.state.search.outer.lookahead_time;
    for (Index of = 0; of < 2; ++of) {
      const Patch& patch = context.patches[of];
      const Index other = context.patches[1 - of].block;
      for (Real time = 0; time <= horizon; time += 0.05 * horizon) {
        for (Index v = 0; v < patch.vertex_count; ++v) {
          const Real out = blocks.outside_of(other, blocks.at(patch.vertex[v], time), time);
          if (separated.vertex[of][v]) CHECK(out > 0);
          separated_vertices += separated.vertex[of][v] != 0;
          near_vertices += !separated.vertex[of][v];
          inside_vertices += out < 0;
        }
        for (Index e = 0; e < patch.edge_count; ++e) {
          if (!separated.edge[of][e]) continue;
          ++separated_edges;
          const Vec start = blocks.at(patch.vertex[patch.edge[e].vertex[0]], time);
          const Vec end = blocks.at(patch.vertex[patch.edge[e].vertex[1]], time);
          for (Real s = 0; s <= 1; s += 0.125)
            CHECK(blocks.outside_of(other, start + s * (end - start), time) > 0);
        }
      }
    }
  }
  CHECK(separated_vertices > near_vertices);
  CHECK(near_vertices > 1000);
  CHECK(inside_vertices > 1000);
  CHECK(separated_edges > 1000);
}

TEST_CASE("faces that a plane holds apart have no vertex inside the other block behind them") {
  Random random(2);
  Index masked = 0, listed = 0;
  for (int k = 0; k < 200; ++k) {
    const TwoBlocks blocks(random);
    const PairSearch& lists = blocks.lists;
    const PairContext context = on_host(pair_context(blocks.model, blocks.state, lists));
    PatchPair pair{.one = 0, .other = 1, .edge = {}, .vertex = {}, .meets = 0, .listed = {}};
    const bool meet = FindMeetingParts{context, false}(pair);
    const Real horizon = blocks.state.search.outer.lookahead_time;
    (meet ? listed : masked) += 1;
    if (meet) continue;
    for (Real time = 0; time <= horizon; time += 0.05 * horizon)
      for (Index i = 0; i < blocks.model.node_count; ++i)
        CHECK(blocks.outside_of(1 - on_host(blocks.model.node_block)[i], blocks.at(i, time), time) >
              0);
  }
  CHECK(masked > 20);
  CHECK(listed > 20);
}

TEST_CASE("the gap between moving faces changes by what GapChange says") {
  ExposedFace x{}, y{};
  x.displacement = {0, 0, -0.3};
  y.displacement = {0, 0, 0.1};
  x.deviation = 0.02, y.deviation = 0.03;
  const GapChange change(x, y, Vec{0, 0, 1});
  CHECK(std::abs(change.least - (-0.45)) < 1e-15);
  CHECK(std::abs(change.most - 0.05) < 1e-15);
  CHECK(std::abs(motion_between(x, y) - 0.45) < 3e-16);
}

TEST_CASE("listed pairs of faces are found with either as mother") {
  Patch patches[2]{};
  for (Index k = 0; k < 2; ++k) {
    patches[k].face_count = 2;
    patches[k].face[0] = 10 + 10 * k, patches[k].face[1] = 11 + 10 * k;
  }
  PatchPair pair{.one = 0, .other = 1, .edge = {}, .vertex = {}, .meets = 0, .listed = {}};
  pair.listed[0] = PatchPair::bit(0, 1);
  pair.listed[1] = PatchPair::bit(1, 0);
  std::vector<FacePair> found;
  ListFacePairs{patches, &pair}.visit(One{0}, [&](const FacePair& of) { found.push_back(of); });
  REQUIRE(found.size() == 2);
  CHECK(found[0].mother == 10);
  CHECK(found[0].face == 21);
  CHECK(found[1].mother == 21);
  CHECK(found[1].face == 10);
}

}  // namespace cdem::test
