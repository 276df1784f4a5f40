// Centre, normal and sharp sides of exposed faces, and what lies beyond their sides.
#include "core/contact/geometry/face_geometry.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Two boxes, bonded on each other, and a tet.
struct Blocks : Scene {
  Blocks() {
    bonded = true;
    add_box({0, 0, 0}, {1, 1, 1});
    add_box({0, 0, 1}, {1, 1, 1});
    Random random(1);
    add_tet(random, {3, 0, 0}, 1);
    build();
    set_interface({{"cohesion", 1e9}});
    start();
    update_all_face_geometry(model, state, {});
  }
  Index exposed() const { return Index(state.search.exposed_face.size()); }
};

}  // namespace

TEST_CASE("flush sides of bonded blocks are not sharp, the others are") {
  const Blocks blocks;
  const FaceGeometry geometry = face_geometry(blocks.state);
  Index flush = 0;
  for (Index x = 0; x < blocks.exposed(); ++x)
    for (Index k = 0; k < geometry.table[x].count(); ++k) {
      const ExposedRow& row = geometry.table[x];
      const bool at_bond =
          blocks.position(row.corner[k]).z == 1 && blocks.position(row.end(k)).z == 1;
      CHECK(geometry.sharp(x, k) == !at_bond);
      flush += at_bond;
    }
  CHECK(flush == 8);
}

TEST_CASE("rows tell triangles from quadrilaterals, length and centre") {
  const Blocks blocks;
  const FaceGeometry geometry = face_geometry(blocks.state);
  const FaceColumns faces = face_columns(blocks.model, blocks.state);
  for (Index x = 0; x < blocks.exposed(); ++x) {
    const Index face = on_host(blocks.state.search.exposed_face)[x];
    CHECK(geometry.is_triangle(x) == (faces.vertex_count(face) == 3));
    CHECK(geometry.length(x) == on_host(blocks.model.face_length)[face]);
    CHECK(distance(geometry.center(x), faces.shape(face).center()) == 0);
    CHECK(distance(geometry.normal(x), faces.shape(face).normal()) == 0);
    for (Index k = 0; k < faces.vertex_count(face); ++k)
      CHECK(faces.side_on(face, on_host(blocks.model.face_edges)[4 * face + k]) == k);
  }
}

TEST_CASE("a contact has the smaller area of two faces; each brings its stiffness") {
  const Blocks blocks;
  const FaceGeometry geometry = face_geometry(blocks.state);
  const ExposedRow* table = geometry.table;
  for (Index x = 0; x < blocks.exposed(); ++x)
    for (Index y = 0; y < blocks.exposed(); ++y) {
      CHECK(geometry.contact_area(x, y) == std::min(table[x].area, table[y].area));
      CHECK(geometry.stiffness(x) == table[x].stiffness);
    }
}

TEST_CASE("one step ago a face was where its nodes came from") {
  Blocks blocks;
  blocks.state.dt_last = 0.01;
  const FaceColumns before = face_columns(blocks.model, blocks.state);
  const FaceShape<Real> was = before.shape(3);
  for (Index i = 0; i < blocks.model.node_count; ++i) {
    put(blocks.motion(i) + 4, Vec{1, 2, 3});
    put(blocks.motion(i), blocks.position(i) + Vec{0.01, 0.02, 0.03});
  }
  const FaceShape<Real> now = before.shape_before(3);
  for (Index k = 0; k < 4; ++k) CHECK(distance(now.x[k], was.x[k]) < 1e-15);
}

TEST_CASE("the normal beyond a side is that of the face there, for one and for a lane") {
  const Blocks blocks;
  const FaceGeometry geometry = face_geometry(blocks.state);
  const FaceColumns faces = face_columns(blocks.model, blocks.state);
  Random random(2);
  for (int round = 0; round < 20; ++round) {
    IndexPack x, k;
    for (Index j = 0; j < lanes; ++j) {
      x.id[j] = random.below(blocks.exposed());
      k.id[j] = random.below(geometry.table[x.id[j]].count());
    }
    const Vec3<Pack> in_lanes = normal_across(faces, geometry, x, k);
    for (Index j = 0; j < lanes; ++j) {
      const Vec n = normal_across(faces, geometry, x.id[j], k.id[j]);
      CHECK(distance(n, Vec{in_lanes.x.n[j], in_lanes.y.n[j], in_lanes.z.n[j]}) == 0);
      const Index across = faces.across(x.id[j], k.id[j]);
      CHECK(distance(n, faces.shape(across).normal()) == 0);
    }
  }
}

}  // namespace cdem::test
