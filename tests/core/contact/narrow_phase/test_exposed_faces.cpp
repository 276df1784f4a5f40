// Faces that can be touched, and what is kept with them.
#include <initializer_list>

#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Ten faces, of which some are exposed.
struct Faces {
  Model m;
  State s;

  Faces() {
    s.search.face_exposed.resize(10, -1);
    s.springs.history.width = 3;
  }
  void change(std::initializer_list<Index> faces, Flag to) {
    Column<Flag> open = open_faces(s);
    for (const Index face : faces) on_host(open)[face] = to;
    renew_exposed(m, s, open);
  }
  Index place(Index face) const { return on_host(s.search.face_exposed)[face]; }
};

}  // namespace

TEST_CASE("a face that is exposed begins without contact, in the order of the model") {
  Faces f;
  f.change({7, 3}, 1);
  const State& s = f.s;
  CHECK(s.search.exposed_face.size() == 2);
  CHECK(f.place(3) == 0);
  CHECK(f.place(7) == 1);
  CHECK(f.place(4) == -1);
  CHECK(s.springs.target.size() == 8);
  for (Index k = 0; k < 8; ++k) CHECK(on_host(s.springs.target)[k] == -1);
  CHECK(s.edges.first.size() == 3);
  CHECK(s.face_geometry.size() == 16);
  CHECK(s.contact_force.size() == 32);
  CHECK(s.springs.history.rows.size() == 24);
  CHECK(on_host(s.springs.history.law)[7] == -1);
  CHECK(s.edges.side_history.rows.size() == 0);
  CHECK(s.springs.rolling.size() == 0);
}

TEST_CASE("where no face comes or leaves, the columns stay where they are") {
  Faces f;
  f.change({7, 3}, 1);
  const Real* const state = f.s.springs.state.data();
  f.change({3}, 1);
  f.change({2}, 0);
  CHECK(f.s.springs.state.data() == state);
}

TEST_CASE("faces of listed pairs are flagged") {
  PairSet set;
  const Index faces[] = {1, 2, 3, 4, 5, 6}, pairs[] = {0, 2};
  set.faces.assign(faces, 6);
  Column<Index> list;
  list.assign(pairs, 2);
  Column<Flag> open;
  open.resize(8);
  open_faces_of(set, list, open);
  const Flag expected[] = {0, 1, 1, 0, 0, 1, 1, 0};
  for (Index face = 0; face < 8; ++face) CHECK(on_host(open)[face] == expected[face]);
}

TEST_CASE("exposed faces keep their springs and edges, and targets follow them") {
  Faces f;
  State& s = f.s;
  f.change({7, 5}, 1);
  s.springs.rolling.resize(2 * 4 * 8);
  const auto place = [&](Index face) { return f.place(face); };
  on_host(s.springs.target)[4 * place(7) + 1] = place(5);
  on_host(s.springs.target_before)[4 * place(5) + 2] = place(7);
  on_host(s.springs.friction)[4 * place(7) + 1] = 11;
  ContactState{1, 2, 3, 4, 5, 6, 7}.store(s.springs.state.data(), 4 * place(5) + 3);
  on_host(s.edges.dashpot)[place(7)] = 12;
  // semi-edges: one of face 5 (place 0), two of face 7 (place 1)
  const Index first[] = {0, 1, 3};
  s.edges.first.assign(first, 3);
  s.edges.contact.resize(12);
  s.edges.state.resize(24);
  s.edges.reaction.resize(24);
  EdgeContact{4 * place(5) + 2, place(7), 20, 0}.store(s.edges.contact.data(), 0);
  EdgeContact{4 * place(7) + 1, place(5), 21, 1}.store(s.edges.contact.data(), 1);
  EdgeContact{4 * place(7) + 3, place(5), 22, 2}.store(s.edges.contact.data(), 2);
  for (Index c = 0; c < 3; ++c) {
    ContactState{100.0 + c, 0, 0, 0, 0, 0, 0}.store(s.edges.state.data(), c);
    on_host(s.edges.reaction)[8 * c + 7] = 200 + c;
  }
  s.search.inner.held_known = true;

  f.change({3, 6}, 1);
  for (Index x = 0; x < 4; ++x) CHECK(place(on_host(s.search.exposed_face)[x]) == x);
  CHECK(place(3) == 0);
  CHECK(place(7) == 3);
  CHECK(on_host(s.springs.target)[4 * place(7) + 1] == place(5));
  CHECK(on_host(s.springs.target)[4 * place(6) + 1] == -1);
  CHECK(on_host(s.springs.target_before)[4 * place(5) + 2] == place(7));
  CHECK(on_host(s.springs.friction)[4 * place(7) + 1] == 11);
  CHECK(on_host(s.springs.friction)[4 * place(3) + 1] == 0);
  CHECK(ContactState::at(s.springs.state.data(), 4 * place(5) + 3).energy_s == 7);
  CHECK(s.springs.rolling.size() == 4 * 4 * 8);
  CHECK(on_host(s.edges.dashpot)[place(7)] == 12);
  const Index first_now[] = {0, 0, 1, 1, 3};
  for (Index x = 0; x < 5; ++x) CHECK(on_host(s.edges.first)[x] == first_now[x]);
  const EdgeContact of_5 = EdgeContact::at(s.edges.contact.data(), 0);
  CHECK(of_5.mother == 4 * place(5) + 2);
  CHECK(of_5.face == place(7));
  CHECK(of_5.edge == 20);
  const EdgeContact of_7 = EdgeContact::at(s.edges.contact.data(), 2);
  CHECK(of_7.mother == 4 * place(7) + 3);
  CHECK(of_7.before == 2);
  CHECK(ContactState::at(s.edges.state.data(), 2).force_n == 102);
  CHECK(on_host(s.edges.reaction)[8 * 2 + 7] == 202);
  CHECK(!s.search.inner.held_known);
}

TEST_CASE("a face that leaves takes its contacts with it, and those that others have with it") {
  Faces f;
  State& s = f.s;
  f.change({2, 5, 7}, 1);
  const auto targets = on_host(s.springs.target), before = on_host(s.springs.target_before);
  targets[4 * 1 + 1] = before[4 * 1 + 1] = 0;  // face 5 on face 2
  targets[4 * 1 + 2] = before[4 * 1 + 2] = 2;  // and on face 7
  for (const Index k : {1, 2}) {
    ContactState{1, 2, 3, 4, 5, 6, 7}.store(s.springs.state.data(), 4 + k);
    on_host(s.springs.reaction)[8 * (4 + k) + 3] = 8;
  }
  const Index first[] = {0, 0, 2, 2};
  s.edges.first.assign(first, 4);
  s.edges.contact.resize(8);
  s.edges.state.resize(16);
  s.edges.reaction.resize(16);
  EdgeContact{4 + 1, 0, 20, -1}.store(s.edges.contact.data(), 0);
  EdgeContact{4 + 2, 2, 21, -1}.store(s.edges.contact.data(), 1);

  f.change({2}, 0);
  CHECK(f.place(2) == -1);
  CHECK(f.place(5) == 0);
  CHECK(on_host(s.springs.target)[1] == -1);
  CHECK(on_host(s.springs.target_before)[1] == -1);
  CHECK(ContactState::at(s.springs.state.data(), 1).force_n == 0);
  CHECK(on_host(s.springs.reaction)[8 + 3] == 0);
  CHECK(on_host(s.springs.target)[2] == 1);
  CHECK(ContactState::at(s.springs.state.data(), 2).force_n == 1);
  CHECK(s.edges.contact.size() == 4);
  CHECK(EdgeContact::at(s.edges.contact.data(), 0).edge == 21);
  CHECK(EdgeContact::at(s.edges.contact.data(), 0).face == 1);
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
