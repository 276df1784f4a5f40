// Forces of all contacts, summed by the faces that they act on in a fixed order.
#include <numeric>

#include "core/contact/force/accumulate.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A tet whose face 0 has a semi-spring at each vertex, all with the top of a box as target.
struct Pressed : Scene {
  std::vector<Index> first, acting;

  Pressed() {
    Random random(1);
    add_box({0, 0, 0}, {2, 2, 2});
    add_tet(random, {1, 1, 3}, 1);
    build();
    start();
    SpringState& c = state.springs;
    const Index exposed = 10;
    first.resize(exposed + 1);
    for (Index k = 0; k < 3; ++k) {
      const Index slot = 4 * 6 + k;
      c.target[slot] = 1;
      for (Index n = 0; n < 4; ++n) c.reaction[8 * slot + n] = random.between(-1, 1);
      for (Index n = 4; n < 8; ++n) c.reaction[8 * slot + n] = random.between(0, 1);
      c.reaction[8 * slot + 3] = 5 + k;  // stiffness
      acting.push_back(slot);
    }
    for (Index x = 2; x <= exposed; ++x) first[x] = 3;
    for (Index x = 0; x < exposed; ++x) state.search.outer.face_listed[x] = 1;
  }
  AccumulateFaceForces kernel() {
    return {ContactsOf{spring_columns(state), edge_columns(state), 10},
            face_columns(model, state),
            state.search.exposed_face.data(),
            state.search.outer.face_listed.data(),
            {first.data(), acting.data()},
            model.rules,
            state.edges.friction.data(),
            state.edges.dashpot.data(),
            state.contact_force.data()};
  }
  Row row(Index face, Index k) { return Row::at(state.contact_force.data() + 4 * (4 * face + k)); }
  Row reaction(Index slot) { return Row::at(state.springs.reaction.data() + 8 * slot); }
};

}  // namespace

TEST_CASE("a vertex gets the force of its semi-spring, the target the opposite by its weights") {
  Pressed pressed;
  pressed.kernel()(One{6});
  pressed.kernel()(One{1});
  for (Index k = 0; k < 3; ++k) {
    CHECK(distance(pressed.row(6, k).vector(), pressed.reaction(24 + k).vector()) == 0);
    CHECK(pressed.row(6, k).n[3] == 5 + k);
  }
  for (Index j = 0; j < 4; ++j) {
    Vec sum{0, 0, 0};
    Real stiffness = 0;
    for (Index slot = 24; slot < 27; ++slot) {
      const Real w = pressed.state.springs.reaction[8 * slot + 4 + j];
      sum = sum - w * pressed.reaction(slot).vector();
      stiffness += w * pressed.reaction(slot).n[3];
    }
    CHECK(distance(pressed.row(1, j).vector(), sum) < 1e-15);
    CHECK(relative_error(pressed.row(1, j).n[3], stiffness) < 1e-15);
  }
}

TEST_CASE("the order in which contacts were listed changes no bit") {
  Pressed pressed, other;
  std::swap(other.acting[0], other.acting[2]);
  pressed.kernel()(One{1});
  other.kernel()(One{1});
  for (Index j = 0; j < 4; ++j)
    for (Index n = 0; n < 4; ++n) CHECK(same_bits(pressed.row(1, j).n[n], other.row(1, j).n[n]));
  CHECK(other.acting == pressed.acting);  // sorted
}

TEST_CASE("long rows are sorted, whatever their order") {
  Random random(2);
  for (const Index count : {0, 1, 2, 50, 1000}) {
    Pressed pressed;
    // contacts of slots without force: only the order shows
    const Index slots = Index(pressed.state.springs.target.size());
    pressed.acting.resize(count);
    for (Index& slot : pressed.acting) slot = random.below(slots);
    std::vector<Index> sorted = pressed.acting;
    std::sort(sorted.begin(), sorted.end());
    for (Index x = 2; x <= 10; ++x) pressed.first[x] = count;
    pressed.kernel()(One{1});
    CHECK(pressed.acting == sorted);
  }
}

TEST_CASE("the action coefficient shares a force among the corners of its face") {
  Pressed pressed;
  pressed.model.rules.action = 0.3;
  pressed.kernel()(One{6});
  Vec sum{0, 0, 0}, given{0, 0, 0};
  for (Index k = 0; k < 3; ++k) {
    Vec expected = Real(0.7) * pressed.reaction(24 + k).vector();
    for (Index j = 0; j < 3; ++j)
      expected = expected + Real(0.1) * pressed.reaction(24 + j).vector();
    CHECK(distance(pressed.row(6, k).vector(), expected) < 2e-16);
    sum = sum + pressed.row(6, k).vector();
    given = given + pressed.reaction(24 + k).vector();
  }
  CHECK(distance(sum, given) < 1e-15);
}

TEST_CASE("an idle face keeps what it has") {
  Pressed pressed;
  pressed.state.search.outer.face_listed[6] = 0;
  pressed.state.contact_force[4 * 24] = 42;
  pressed.kernel()(One{6});
  CHECK(pressed.state.contact_force[4 * 24] == 42);
}

TEST_CASE("contacts are counted and listed by their targets") {
  Pressed pressed;
  pressed.state.springs.target[0] = 7;
  std::vector<Index> count(10), place(40), first(11), contact(4);
  const ContactsOf all{spring_columns(pressed.state), edge_columns(pressed.state), 10};
  for_each_item({}, 10, CountContactsByTarget{all, count.data(), place.data(), true});
  CHECK(count == std::vector<Index>{0, 3, 0, 0, 0, 0, 0, 1, 0, 0});
  std::partial_sum(count.begin(), count.end(), first.begin() + 1);
  for_each_item({}, 10, ListContactsByTarget{all, place.data(), {first.data(), contact.data()}});
  std::sort(contact.begin(), contact.begin() + 3);
  CHECK(contact == std::vector<Index>{24, 25, 26, 0});
}

}  // namespace cdem::test
