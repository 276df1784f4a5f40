// Matrices of contacts: two bars that lie across each other touch by vertices and by edges.
#include "core/contact/force/views.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/rest/contact_matrix.hpp"
#include "core/rest/rest.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

struct Bars : Scene {
  Bars() {
    add_box({-2, -0.5, -1}, {4, 1, 1}, true);
    add_box({-0.6, -2, 0}, {1, 4, 1});
    add_box({-0.5, -0.4, 1}, {0.8, 0.8, 0.8});
    build();
    model.gravity = {0, 0, -9.81};
    model.contact_damping = 0.5;
    set_interface({{"friction_angle", 0.5}});
    start();
    step(200);
    for (Index i = 0; i < model.node_count; ++i) put(motion(i) + 4, Vec{0, 0, 0});
  }
  PressedContacts contacts() {
    return {.faces = face_columns(model, state),
            .geometry = face_geometry(state),
            .laws = contact_laws(model, state),
            .rules = model.rules,
            .springs = spring_columns(state),
            .edges = edge_columns(state)};
  }
};

/// Nothing resists a translation, and the stiffer spring is that of the last step.
void check_contact(const ItemMatrix& k, Real largest) {
  Real trace = 0;
  for (Index a = 0; a < k.count; ++a)
    for (Index n = 0; n < 9; ++n) {
      Real sum = 0;
      for (Index b = 0; b < k.count; ++b) sum += k.block[a][b][n];
      CHECK(std::abs(sum) < 1e-12 * largest);
      CHECK(k.block[a][a][n] == doctest::Approx(k.block[a][a][n % 3 * 3 + n / 3]));
    }
  for (Index a = 0; a < k.count; ++a) trace += k.block[a][a][0] + k.block[a][a][8];
  CHECK(trace > 0);
}

}  // namespace

TEST_CASE("springs of vertices and of edges that are pressed") {
  Bars bars;
  const PressedContacts contacts = bars.contacts();
  Index vertices = 0, edges = 0;
  for (Index slot = 0; slot < 4 * Index(bars.state.search.exposed_face.size()); ++slot) {
    const ItemMatrix k = contacts.spring_matrix(slot);
    if (k.count == 0) continue;
    ++vertices;
    check_contact(k, contacts.springs.reaction[8 * std::size_t(slot) + 3]);
  }
  for (Index place = 0; place < Index(bars.state.edges.contact.size() / 4); ++place) {
    const ItemMatrix k = contacts.edge_matrix(place);
    if (k.count == 0) continue;
    ++edges;
    check_contact(k, contacts.edges.reaction[8 * std::size_t(place) + 3]);
  }
  CHECK(vertices >= 4);
  CHECK(edges >= 4);
}

TEST_CASE("bars that lie across each other rest by a solve") {
  Bars bars;
  const RestFound found = solve_for_rest(bars.model, bars.state, 1e-8);
  CHECK(found.rounds > 0);
  CHECK(found.rounds < 6);
  CHECK(found.after < 1e-8);
}

}  // namespace cdem::test
