// A vertex and a face that it may touch, one by one and a lane at a time.
#include "core/contact/geometry/views.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/narrow_phase/vertex_face.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

struct Two : Scene {
  Two() {
    Random random(1);
    add_tet(random, {0, 0, 0}, 1);
    add_box({0.2, 0.2, 0.2}, {1, 1.5, 2});
    build();
    start();
    update_all_face_geometry(model, state, {});
  }
  Index exposed() const { return Index(state.search.exposed_face.size()); }
};

}  // namespace

TEST_CASE("the indented point lies alpha of the way from the vertex to the centre, Eq. 3") {
  const Two two;
  const FaceColumns faces = face_columns(two.model, two.state);
  const FaceGeometry geometry = face_geometry(two.state);
  const SearchRules& rules = two.model.rules;
  for (Index m = 0; m < 4; ++m)
    for (Index t = 4; t < two.exposed(); ++t) {
      const Index node = geometry.table[m].corner[0];
      const auto pair = VertexFace<Real>::at(faces, geometry, rules, m, node, t);
      const FaceShape<Real> mother = faces.shape(m), target = faces.shape(t);
      CHECK(distance(pair.v, two.position(node)) == 0);
      const Vec indented = pair.v + rules.indentation * (mother.center() - pair.v);
      CHECK(distance(pair.p, indented) == 0);
      CHECK(distance(pair.center, target.center()) == 0);
      CHECK(distance(pair.normal, target.normal()) == 0);
      CHECK(pair.length ==
            std::min(on_host(two.model.face_length)[m], on_host(two.model.face_length)[t]));
      CHECK(pair.target_length == -on_host(two.model.face_length)[t]);  // a quadrilateral
      CHECK(bool(pair.opposes) ==
            (dot(mother.normal(), target.normal()) < -two.model.rules.opposing));
    }
}

TEST_CASE("pairs of a lane are those of its numbers") {
  const Two two;
  const FaceColumns faces = face_columns(two.model, two.state);
  const FaceGeometry geometry = face_geometry(two.state);
  const SearchRules& rules = two.model.rules;
  Random random(2);
  for (int round = 0; round < 20; ++round) {
    IndexPack m, t, node;
    for (Index j = 0; j < lanes; ++j) {
      m.id[j] = random.below(two.exposed());
      t.id[j] = random.below(two.exposed());
      node.id[j] = geometry.table[m.id[j]].corner[random.below(4)];
    }
    const auto pack = VertexFace<Pack>::at(faces, geometry, rules, m, node, t);
    for (Index j = 0; j < lanes; ++j) {
      const auto one = VertexFace<Real>::at(faces, geometry, rules, m.id[j], node.id[j], t.id[j]);
      CHECK(same_bits(pack.p.x.n[j], one.p.x));
      CHECK(same_bits(pack.v.z.n[j], one.v.z));
      CHECK(same_bits(pack.center.y.n[j], one.center.y));
      CHECK(same_bits(pack.normal.z.n[j], one.normal.z));
      CHECK(same_bits(pack.length.n[j], one.length));
      CHECK(same_bits(pack.target_length.n[j], one.target_length));
      CHECK(holds(pack.opposes, j) == one.opposes);
    }
  }
}

TEST_CASE("a candidate belongs to the vertex whose row it is in") {
  // slots of faces 0 and 1: rows of 2, 0, 1, 3 and 1, 1, 0, 2 candidates
  const Index first[] = {0, 2, 2, 3, 6, 7, 8, 8, 10};
  const Index vertex[] = {0, 0, 2, 3, 3, 3, 0, 1, 3, 3};
  for (Index c = 0; c < 6; ++c) CHECK(vertex_of(first, 0, c) == vertex[c]);
  for (Index c = 6; c < 10; ++c) CHECK(vertex_of(first, 1, c) == vertex[c]);
}

TEST_CASE("a list takes all its faces, or those that are marked") {
  const Index other[] = {5, 6, 7};
  const Flag may[] = {1, 0, 1};
  const FaceList all{other, nullptr, 3}, some{other, may, 3};
  for (Index c = 0; c < 3; ++c) {
    CHECK(all.takes(c));
    CHECK(some.takes(c) == (c != 1));
  }
}

}  // namespace cdem::test
