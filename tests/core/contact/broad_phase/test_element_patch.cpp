// The exposed faces of one element, with its vertices and edges, each once.
#include "core/contact/broad_phase/element_patch.hpp"
#include "core/contact/broad_phase/pair_search.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A block of each shape, by itself.
struct Shapes : Scene {
  Shapes() {
    add<Hex8>(at(Reference<Hex8>::corners(), 0));
    add<Wedge6>(at(Reference<Wedge6>::corners(), 10));
    add<Pyramid5>(at(Reference<Pyramid5>::corners(), 20));
    add<Tet4>(at(Reference<Tet4>::corners(), 30));
    build();
    for (Index b = 0; b < 4; ++b) set_motion(b, {0.1, 0, 0});
    start();
  }
  PairSearch search() const {
    PairSearch found;
    search_pairs(model, state, found);
    return found;
  }

 private:
  template <class Corners>
  static Corners at(Corners corners, Real x) {
    for (Vec& c : corners) c = c + Vec{x, 0, 0};
    return corners;
  }
};

}  // namespace

TEST_CASE("a patch has the vertices, edges and faces of its element once") {
  const Shapes shapes;
  const PairSearch lists = shapes.search();
  REQUIRE(lists.patches.size() == 4);
  const Index faces[] = {6, 5, 5, 4}, vertices[] = {8, 6, 5, 4}, edges[] = {12, 9, 8, 6};
  for (const Patch& patch : on_host(lists.patches)) {
    CHECK(patch.face_count == faces[patch.block]);
    CHECK(patch.vertex_count == vertices[patch.block]);
    CHECK(patch.edge_count == edges[patch.block]);
    CHECK(patch.whole);
    for (Index e = 0; e < patch.edge_count; ++e) {
      CHECK(patch.edge[e].faces == 2);
      const Index ends[] = {patch.vertex[patch.edge[e].vertex[0]],
                            patch.vertex[patch.edge[e].vertex[1]]};
      const Index* of_mesh = shapes.model.edge_nodes.data() + 2 * patch.edge[e].id;
      CHECK(std::min(ends[0], ends[1]) == std::min(of_mesh[0], of_mesh[1]));
      CHECK(std::max(ends[0], ends[1]) == std::max(of_mesh[0], of_mesh[1]));
    }
    for (Index v = 0; v < patch.vertex_count; ++v)
      for (Index i = 0; i < patch.face_count; ++i) {
        const Index face = on_host(shapes.state.search.exposed_face)[patch.face[i]];
        if (patch.corner[v][i] >= 0)
          CHECK(on_host(shapes.model.face_nodes)[4 * face + patch.corner[v][i]] == patch.vertex[v]);
      }
  }
}

TEST_CASE("boxes hold faces and patches on their whole way") {
  Shapes shapes;
  shapes.state.search.outer.lookahead_time = 0.5;
  PairSearch lists = shapes.search();
  list_patches(shapes.model, shapes.state, lists);
  for (const Patch& patch : on_host(lists.patches))
    for (Index v = 0; v < patch.vertex_count; ++v)
      for (const Real time : {0.0, 0.25, 0.5}) {
        const Vec x = shapes.position(patch.vertex[v]) + time * shapes.velocity(patch.vertex[v]);
        Box point = Box::nothing();
        point.include(x);
        CHECK(patch.box.overlaps(point));
      }
  for (const ExposedFace& face : on_host(lists.exposed))
    CHECK(distance(face.displacement, Vec{0.05, 0, 0}) < 1e-16);
}

TEST_CASE("sides of exposed faces are sharp where the faces bend, and know what is across") {
  const Shapes shapes;
  const PairSearch lists = shapes.search();
  const auto exposed = on_host(lists.exposed);
  const auto sides = on_host(lists.sides);
  for (std::size_t x = 0; x < exposed.size(); ++x)
    for (Index k = 0; k < exposed[x].shape.count(); ++k) {
      const ExposedSide& side = sides[4 * x + k];
      CHECK(side.sharp);
      CHECK(!side.rises);  // all are convex
      REQUIRE(side.across >= 0);
      CHECK(exposed[side.across].block == exposed[x].block);
      CHECK(relative_error(side.length, norm(side.along)) < 1e-15);
      CHECK(std::abs(dot(side.fall, side.along)) < 1e-14);
    }
}

}  // namespace cdem::test
