// The module of surface laws: who acts, from when, and what it knows.
#include "core/model/applied_lists.hpp"
#include "core/nodes/applied.hpp"
#include "core/nodes/curves.hpp"
#include "core/surface/data.hpp"
#include "core/surface/laws.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A box with two entries on its first triangles: a pressure from the start, and one that waits.
struct WithSurfaces : Scene {
  WithSurfaces() {
    add_tet({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
    build();
    find_loads_and_supports(model, state);
    SurfaceSet& g = given_of<Surface>(model);
    Surface::take_counts(g, [](const char* name) {
      const std::string of = name;
      return of == "surface.count" || of == "surface_triangles.count" ? 2 : 0;
    });
    for (Index e = 0; e < 2; ++e) {
      push(g.law, 0), push(g.curve, 0), push(g.waits, e == 1);
      push(g.parameters, 12);
      for (Index k = 1; k < surface_row; ++k) push(g.parameters, 0);
      push(g.triangles.area, 0.5);
    }
    g.triangles.nodes.resize(3 * g.triangles.stride);
    g.triangles.entry.resize(g.triangles.stride);
    for (Index f = 0; f < 2; ++f) {
      on_host(g.triangles.entry)[f] = f;
      for (Index k = 0; k < 3; ++k)
        on_host(g.triangles.nodes)[k * g.triangles.stride + f] = k == 0 ? 0 : 3 - k;  // 0, 2, 1
    }
    list_applied(model, state);
    Surface::start(model, state);
  }
  void add_tet(const std::array<Vec, 4>& corners) { add<Tet4>(corners); }
  Vec force(Index node) {
    return vector_at(on_host(applied_of<Surface>(state).sum).data() + 4 * node);
  }
  Real place(Index face, Index row) {
    const SurfaceFaces& faces = given_of<Surface>(model).triangles;
    return on_host(state_of<Surface>(state).triangles.place)[row * faces.stride + face];
  }
};

}  // namespace

TEST_CASE("an entry that waits begins to act when it is told to, from where its faces lie then") {
  WithSurfaces scene;
  change_applied(scene.model, scene.state);
  CHECK(distance(scene.force(1), Vec{0, 0, 2}) < 1e-14);  // 12 Pa on 0.5 m2, a third a vertex
  scene.motion(1)[0] = 3;
  const Flag second[2] = {0, 1};
  Surface::begin(scene.model, scene.state, second);
  change_applied(scene.model, scene.state);
  CHECK(distance(scene.force(1), Vec{0, 0, 12}) < 1e-14);  // both, on thrice the area
  CHECK(scene.place(0, 6) == 1);                           // x of the third vertex, node 1
  CHECK(scene.place(1, 6) == 3);
}

TEST_CASE(
    "faces of nodes that come in are new to their laws, and those that are out have no force") {
  WithSurfaces scene;
  scene.motion(1)[0] = 3;
  const std::vector<Flag> none(4), all(4, 1);
  Surface::renew(scene.model, scene.state, none.data());
  CHECK(scene.place(0, 6) == 1);
  Surface::renew(scene.model, scene.state, all.data());
  CHECK(scene.place(0, 6) == 3);
  scene.state.nodes.out.assign(all);
  change_applied(scene.model, scene.state);
  for (Index node = 0; node < 4; ++node) CHECK(norm(scene.force(node)) == 0);
}

TEST_CASE("a pressure stiffens nothing") {
  const WithSurfaces scene;
  Index visits = 0;
  Surface::stiffness_of(given_of<Surface>(scene.model))([&](Index, Real) { ++visits; });
  CHECK(visits == 0);
}

}  // namespace cdem::test
