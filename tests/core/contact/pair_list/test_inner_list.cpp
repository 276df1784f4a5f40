// The inner pair list holds a part of the outer one, and every contact until it is made again.
#include <set>

#include "core/contact/geometry/views.hpp"
#include "core/contact/pair_list/inner_list.hpp"
#include "core/contact/pair_list/prune.hpp"
#include "core/contact/pair_list/rebuild.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A tet that falls with a spin onto a fixed box, or onto a triangle.
struct Landing : Scene {
  explicit Landing(bool on_triangle = false) {
    Random random(3);
    if (on_triangle)
      add<Tet4>({{{0, 0, -2}, {-2, -2, 0}, {2, -2, 0}, {0, 3, 0}}}, true);
    else
      add_box({-1, -1, -1}, {2, 2, 1}, true);
    const Index tet = add_tet(random, {0, 0, 0.8}, 1);
    build();
    set_interface({{"friction_angle", 0.4}});
    set_motion(tet, {0.2, 0.1, -1}, {1, 2, 0});
    model.gravity = {0, 0, -9.81};
    start();
  }
  std::set<std::pair<Index, Index>> inner() const { return pairs(list().first, list().candidate); }
  std::set<std::pair<Index, Index>> outer() const {
    const OuterList& outer = state.search.outer;
    const auto of = on_host(outer.vf_pairs);
    Column<Index> faces;
    for (const Index pair : on_host(outer.slot_pairs)) push(faces, of[of.size() / 2 + pair]);
    return pairs(outer.slot_first, faces);
  }
  const InnerList& list() const { return state.search.inner; }

 private:
  static std::set<std::pair<Index, Index>> pairs(const Column<Index>& first,
                                                 const Column<Index>& other) {
    std::set<std::pair<Index, Index>> all;
    for (std::size_t slot = 0; slot + 1 < first.size(); ++slot)
      for (Index c = on_host(first)[slot]; c < on_host(first)[slot + 1]; ++c)
        all.insert({Index(slot), on_host(other)[c]});
    return all;
  }
};

}  // namespace

TEST_CASE("the pairs of two edges are found whichever of them comes first") {
  // edges of patches, which are edges 1, 2, 0, 2 of the mesh, and pairs of them
  const Index edges[] = {1, 2, 0, 2}, of[2][6] = {{2, 1, 0, 3, 2, 0}, {0, 2, 1, 0, 3, 3}};
  const Index first[] = {0, 3, 6, 6}, listed[] = {0, 1, 4, 2, 3, 5};
  const PairsOfEdges pairs{first, listed, {.of = {of[0], 6}, .sides = nullptr, .edges = edges}};
  const auto found = [&](Index a, Index b) {
    std::set<Index> all;
    pairs.each(a, b, [&](Index pair) { all.insert(pair); });
    return all;
  };
  CHECK(found(0, 1) == std::set<Index>{0});
  CHECK(found(1, 0) == std::set<Index>{0});
  CHECK(found(2, 0) == std::set<Index>{1, 4});
  CHECK(found(2, 1) == std::set<Index>{2, 3, 5});
}

TEST_CASE("the inner list is part of the outer one, and smaller") {
  Landing landing;
  std::size_t inner = 0, outer = 0;
  for (int n = 0; n < 100; ++n) {
    landing.step(5);
    const auto all = landing.outer(), near = landing.inner();
    CHECK(std::includes(all.begin(), all.end(), near.begin(), near.end()));
    inner += near.size();
    outer += all.size();
  }
  CHECK(inner > 0);
  CHECK(2 * inner < outer);
}

TEST_CASE("contacts are on the inner list when they begin, and as long as they last") {
  Landing landing;
  Index held = 0;
  for (int n = 0; n < 500; ++n) {
    landing.step(1);
    const auto near = landing.inner();
    for (std::size_t slot = 0; slot < landing.state.springs.target.size(); ++slot) {
      const Index target = on_host(landing.state.springs.target)[slot];
      if (target < 0) continue;
      ++held;
      CHECK(near.count({Index(slot), target}) == 1);
    }
  }
  CHECK(held > 50);
}

TEST_CASE("what a vertex may reach within the skins is on the inner list") {
  Landing landing(true);
  const Model& m = landing.model;
  State& s = landing.state;
  Index close = 0;
  for (int n = 0; n < 400; ++n) {
    landing.step(1);
    prune_pair_list(m, s, {});
    const auto near = landing.inner();
    const FaceColumns faces = face_columns(m, s);
    for (const auto& [slot, t] : landing.outer()) {
      const FaceShape<Real> mother = faces.shape(on_host(s.search.exposed_face)[slot / 4]),
                            target = faces.shape(on_host(s.search.exposed_face)[t]);
      const Vec v = mother.x[slot % 4], n_t = target.normal();
      const Vec p = v + m.rules.indentation * (mother.center() - v);
      const bool opposes = dot(mother.normal(), n_t) < -m.rules.opposing;
      const Real gap = project(target, v, n_t).gap;
      if (!opposes || !target.inside(p, n_t, 0.0) || gap < 0) continue;
      const auto skin_of = [&](Index x, Index k) {
        return on_host(
            landing.list().skin)[on_host(m.face_nodes)[4 * on_host(s.search.exposed_face)[x] + k]];
      };
      Real skins = 0;
      for (Index k = 0; k < target.count(); ++k) skins = std::max(skins, skin_of(t, k));
      skins += skin_of(slot / 4, slot % 4);
      if (gap > skins) continue;
      ++close;
      CHECK(near.count({slot, t}) == 1);
    }
  }
  CHECK(close > 5);
}

TEST_CASE("the inner list is made again when a node has left its inner skin") {
  Landing landing;
  do landing.step(1);
  while (!names_pairs(landing.state.search.outer));
  const Real made = landing.list().built_time;
  const auto prune_if_due = [&] {
    pair_list_is_due(landing.model, landing.state);  // notes it of the inner list, too
    prune_pair_list_if_due(landing.model, landing.state, {});
  };
  prune_if_due();
  CHECK(landing.list().built_time == made);
  const Index node = on_host(landing.state.search.outer.predicted_nodes)[8];
  landing.motion(node)[2] += 2 * on_host(landing.list().skin)[node];
  prune_if_due();
  CHECK(landing.list().built_time == landing.state.time);
}

}  // namespace cdem::test
