// Faces that can be touched, and what is kept with them.
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

TEST_CASE("a face that is exposed begins without contact, once") {
  State s;
  s.search.face_exposed.resize(10, -1);
  expose(s, 7);
  expose(s, 3);
  expose(s, 7);
  CHECK(s.search.exposed_face.size() == 2);
  CHECK(on_host(s.search.face_exposed)[7] == 0);
  CHECK(on_host(s.search.face_exposed)[3] == 1);
  CHECK(s.springs.target.size() == 8);
  for (Index k = 0; k < 8; ++k) CHECK(on_host(s.springs.target)[k] == -1);
  CHECK(s.edges.first.size() == 3);
  CHECK(s.face_geometry.size() == 16);
}

TEST_CASE("sorted faces keep their springs and edges, and targets follow them") {
  State s;
  s.search.face_exposed.resize(10, -1);
  for (const Index face : {7, 3, 5}) expose(s, face);
  const auto place = [&](Index face) { return on_host(s.search.face_exposed)[face]; };
  on_host(s.springs.target)[4 * place(7) + 1] = place(3);
  on_host(s.springs.target_before)[4 * place(5) + 2] = place(7);
  on_host(s.springs.friction)[4 * place(7) + 1] = 11;
  ContactState{1, 2, 3, 4, 5, 6, 7}.store(s.springs.state.data(), 4 * place(5) + 3);
  on_host(s.edges.dashpot)[place(3)] = 12;
  // semi-edges: one of face 7 (place 0), two of face 5 (place 2)
  const Index first[] = {0, 1, 1, 3};
  s.edges.first.assign(first, 4);
  s.edges.contact.resize(12);
  s.edges.state.resize(24);
  s.edges.reaction.resize(24);
  EdgeContact{4 * place(7) + 2, place(5), 20, 0}.store(s.edges.contact.data(), 0);
  EdgeContact{4 * place(5) + 1, place(3), 21, 1}.store(s.edges.contact.data(), 1);
  EdgeContact{4 * place(5) + 3, place(7), 22, 2}.store(s.edges.contact.data(), 2);
  for (Index c = 0; c < 3; ++c)
    ContactState{100.0 + c, 0, 0, 0, 0, 0, 0}.store(s.edges.state.data(), c);

  sort_exposed(s);
  for (Index x = 0; x < 3; ++x) {
    CHECK(on_host(s.search.exposed_face)[x] == 3 + 2 * x);
    CHECK(place(on_host(s.search.exposed_face)[x]) == x);
  }
  CHECK(on_host(s.springs.target)[4 * place(7) + 1] == place(3));
  CHECK(on_host(s.springs.target_before)[4 * place(5) + 2] == place(7));
  CHECK(on_host(s.springs.friction)[4 * place(7) + 1] == 11);
  CHECK(ContactState::at(s.springs.state.data(), 4 * place(5) + 3).energy_s == 7);
  CHECK(on_host(s.edges.dashpot)[place(3)] == 12);
  CHECK(on_host(s.edges.first)[3] == 3);
  const Index c = on_host(s.edges.first)[place(7)];
  const EdgeContact of_7 = EdgeContact::at(s.edges.contact.data(), c);
  CHECK(of_7.mother == 4 * place(7) + 2);
  CHECK(of_7.face == place(5));
  CHECK(of_7.edge == 20);
  CHECK(ContactState::at(s.edges.state.data(), c).force_n == 100);
  const EdgeContact of_5 =
      EdgeContact::at(s.edges.contact.data(), on_host(s.edges.first)[place(5)] + 1);
  CHECK(of_5.face == place(7));
  CHECK(of_5.mother == 4 * place(5) + 3);
}

TEST_CASE("rows of exposed faces: corners, faces beside, a vertex's share of the area") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 2, 3});
  scene.add<Tet4>({{{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}}});
  scene.build();
  scene.start();
  for (Index x = 0; x < 10; ++x) {
    const ExposedRow& row = on_host(scene.state.search.exposed)[x];
    CHECK(row.count() == (x < 6 ? 4 : 3));
    CHECK(row.area == on_host(scene.model.face_area)[x] / row.count());
    for (Index k = 0; k < row.count(); ++k) {
      CHECK(row.corner[k] == on_host(scene.model.face_nodes)[4 * x + k]);
      CHECK(row.end(k) == row.corner[(k + 1) % row.count()]);
      // the face beside has the same edge
      const Index edge = on_host(scene.model.face_edges)[4 * x + k], beside = row.beside[k];
      REQUIRE(beside >= 0);
      const Index* edges = scene.model.face_edges.data() + 4 * beside;
      CHECK(std::count(edges, edges + 4, edge) == 1);
    }
    if (x >= 6) CHECK(row.corner[3] == row.corner[2]);
  }
}

TEST_CASE("centre, normal and sharp sides of every face are where its nodes are") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 2, 3});
  scene.build();
  scene.start();
  update_all_face_geometry(scene.model, scene.state, {});
  const Real* top = scene.state.face_geometry.data() + 8;
  CHECK(distance(vector_at(top), Vec{0.5, 1, 3}) < 1e-15);
  CHECK(distance(vector_at(top + 4), Vec{0, 0, 1}) == 0);
  CHECK(top[3] == 15);  // four sharp sides
  CHECK(top[7] == -on_host(scene.model.face_length)[1]);
}

}  // namespace cdem::test
