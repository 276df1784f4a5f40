// Forces of all contacts, summed by the faces that they act on in a fixed order.
#include "core/base/primitives.hpp"
#include "core/contact/force/accumulate.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/diagnostics/energy.hpp"
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
      on_host(c.target)[slot] = 1;
      for (Index n = 0; n < 4; ++n) on_host(c.reaction)[8 * slot + n] = random.between(-1, 1);
      for (Index n = 4; n < 8; ++n) on_host(c.reaction)[8 * slot + n] = random.between(0, 1);
      on_host(c.reaction)[8 * slot + 3] = 5 + k;  // stiffness
      acting.push_back(slot);
    }
    for (Index x = 2; x <= exposed; ++x) first[x] = 3;
    for (Index x = 0; x < exposed; ++x) on_host(state.search.outer.face_listed)[x] = 1;
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
      const Real w = on_host(pressed.state.springs.reaction)[8 * slot + 4 + j];
      sum = sum - w * pressed.reaction(slot).vector();
      stiffness += w * pressed.reaction(slot).n[3];
    }
    CHECK(distance(pressed.row(1, j).vector(), sum) < 1e-15);
    CHECK(relative_error(pressed.row(1, j).n[3], stiffness) < 1e-15);
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
  on_host(pressed.state.search.outer.face_listed)[6] = 0;
  on_host(pressed.state.contact_force)[4 * 24] = 42;
  pressed.kernel()(One{6});
  CHECK(on_host(pressed.state.contact_force)[4 * 24] == 42);
}

TEST_CASE("contacts are listed by their targets") {
  Pressed pressed;
  on_host(pressed.state.springs.target)[0] = 7;
  const ContactsOf all{spring_columns(pressed.state), edge_columns(pressed.state), 10};
  Column<Index> first, contact;
  list_rows_in_room({}, 10, 40, 10, all, first, contact);
  CHECK(fetch(first) == std::vector<Index>{0, 0, 3, 3, 3, 3, 3, 3, 4, 4, 4});
  CHECK(contact.size() == 40);  // room for all
  const std::vector<Index> expected{24, 25, 26, 0};
  CHECK(std::equal(expected.begin(), expected.end(), on_host(contact).begin()));
}

namespace {

/// Two ridges (wedges) that cross, the upper one upside down; it falls and slides along both.
struct Ridges : Scene {
  Ridges() {
    add<Wedge6>({{{1, -2, -1}, {-1, -2, -1}, {0, -2, 0}, {1, 2, -1}, {-1, 2, -1}, {0, 2, 0}}});
    const Real s = std::sin(1.2), c = std::cos(1.2), gap = 1e-4;
    const auto turned = [&](Real x, Real y, Real z) {
      return Vec{c * x - s * y + 0.1, s * x + c * y - 0.3, z};
    };
    const Index upper =
        add<Wedge6>({{turned(-1, -2, 1 + gap), turned(1, -2, 1 + gap), turned(0, -2, gap),
                      turned(-1, 2, 1 + gap), turned(1, 2, 1 + gap), turned(0, 2, gap)}});
    build();
    model.step_given = 1e-4;
    set_interface({{"friction_angle", 0.5}});
    set_motion(upper, {0.6, 0.3, -1});
    start();
  }
  Index edge_count() const { return Index(state.edges.contact.size() / 4); }
  Real shear_energy() const {
    Real sum = 0;
    for (Index c = 0; c < edge_count(); ++c)
      sum += ContactState::at(state.edges.state.data(), c).energy_s;
    return sum;
  }
};

}  // namespace

TEST_CASE("forces of crossing edges and their moments sum to zero") {
  Ridges ridges;
  ridges.step(50);
  CHECK(ridges.edge_count() == 4);
  Vec force{0, 0, 0}, moment{0, 0, 0};
  Real size = 0;
  for (std::size_t x = 0; x < ridges.state.search.exposed_face.size(); ++x)
    for (Index k = 0; k < 4; ++k) {
      const Index node =
          on_host(ridges.model.face_nodes)[4 * on_host(ridges.state.search.exposed_face)[x] + k];
      if (node < 0) continue;
      // where the node was when the force was found
      const Vec at = ridges.position(node) - ridges.state.dt_last * ridges.velocity(node);
      const Vec f = vector_at(ridges.state.contact_force.data() + (4 * x + k) * 4);
      force = force + f;
      moment = moment + cross(at, f);
      size += norm(f);
    }
  CHECK(size > 0);
  CHECK(norm(force) < 1e-15 * size);
  CHECK(norm(moment) < 1e-14 * size);
}

TEST_CASE("energies close in every step while edges alone press and slide") {
  Ridges ridges;
  Real shear = 0, worst = 0;
  for (int n = 0; n < 1000; ++n) {
    ridges.step(1);
    worst = std::max(worst, std::abs(energies(ridges.model, ridges.state).error));
    shear = std::max(shear, ridges.shear_energy());
  }
  const Energies e = energies(ridges.model, ridges.state);
  CHECK(ridges.edge_count() == 0);
  CHECK(shear > 0.03 * e.start);
  CHECK(e.terms[energy_term("friction")] > 0.05 * e.start);
  CHECK(worst < 1e-4);  // falls with the square of the time step
}

}  // namespace cdem::test
