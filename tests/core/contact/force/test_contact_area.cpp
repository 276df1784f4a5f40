// Areas of contacts: what faces share, given to what presses on them.
#include "core/contact/force/contact_area.hpp"
#include "core/contact/force/force.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/geometry/views.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A box of 1 m2 comes down onto a bed of one box, or of two that meet below it, of a law that asks
/// for the area of contacts, which does not matter here.
struct Touching : Scene {
  Touching(const std::vector<Real>& seams, bool asks) {
    Real from = -1;
    for (const Real seam : seams) {
      add_box({from, -1, -1}, {seam - from, 3, 1}, true);
      from = seam;
    }
    add_box({from, -1, -1}, {2 - from, 3, 1}, true);
    const Index box = add_box({0, 0, 0}, {1, 1, 1});
    build();
    set_interface({{"friction_angle", 0.3}});
    set_motion(box, {0, 0, -0.1});
    on_host(model.interfaces)[0].law = asks ? voellmy() : 0;
    if (asks) {  // no turbulence to speak of
      on_host(model.interface_parameters)[5] = 1e30;
      on_host(model.interface_parameters)[6] = 1;
    }
    note_interfaces(model);
    start();
    step(4);
  }
  static Index voellmy() {
    Index found = -1;
    InterfaceLaws::for_each([&]<template <class> class Law, Index number>() {
      if (std::string_view(Law<Real>::text.name) == "voellmy") found = number;
    });
    return found;
  }
  /// Sum of the areas that contacts are given [m2], and how many there are.
  std::pair<Real, int> given() {
    const ContactLaws laws = contact_laws(model, state);
    const FaceGeometry geometry = face_geometry(state);
    Real sum = 0;
    int count = 0;
    const auto add = [&](Index m, Index t, Real part, bool pressed) {
      ContactSpring<Real> spring = laws.spring(geometry, Index(0), m, t);
      spring.area *= part;
      const Real before = spring.n();
      laws.take_true_area<InterfaceLaws>(spring, geometry, Index(0), m, t, pressed);
      CHECK(relative_error(spring.n(), before) < 1e-14);
      CHECK(spring.has_area == 1);
      if (!pressed) return;
      sum += spring.area;
      ++count;
    };
    for (Index slot = 0; slot < Index(state.springs.target.size()); ++slot)
      if (on_host(state.springs.target)[slot] >= 0)
        add(slot / 4, on_host(state.springs.target)[slot], 0.5, true);
    for (std::size_t c = 0; c < state.edges.contact.size() / 4; ++c) {
      const EdgeContact edge = EdgeContact::at(state.edges.contact.data(), c);
      add(edge.mother / 4, edge.face, 1,
          edge.before >= 0 &&
              ContactState::at(state.edges.old_state.data(), edge.before).penetration > 0);
    }
    return {sum, count};
  }
};

}  // namespace

TEST_CASE("contacts have the area of the face that lies on others, whatever the seams") {
  for (const std::vector<Real>& seams :
       {std::vector<Real>{}, {0.5}, {0.25, 0.75}, {0.1, 0.3, 0.6, 0.95}}) {
    Touching blocks(seams, true);
    const auto [area, count] = blocks.given();
    CHECK(count >= 4);
    CHECK(relative_error(area, 1) < 2e-5);  // the box has bulged by what it bears
  }
}

TEST_CASE("models whose laws ask for no area find none, and contacts keep their shares") {
  Touching blocks({0.5}, false);
  CHECK(blocks.state.contact_areas.per_stiffness.size() == 0);
  ContactSpring<Real> spring{.area = 0.3, .stiffness = JointStiffness<Real>::of(1e9, 2e9)};
  contact_laws(blocks.model, blocks.state)
      .take_true_area<InterfaceLaws>(spring, face_geometry(blocks.state), Index(0), Index(0),
                                     Index(1), true);
  CHECK(spring.area == 0.3);
  CHECK(spring.has_area == 0);
}

TEST_CASE("a contact that just began has next to no area") {
  Touching blocks({}, true);
  const ContactLaws laws = contact_laws(blocks.model, blocks.state);
  ContactSpring<Real> spring{.area = 0.3, .stiffness = JointStiffness<Real>::of(1e9, 2e9)};
  laws.take_true_area<InterfaceLaws>(spring, face_geometry(blocks.state), Index(0), Index(0),
                                     Index(1), false);
  CHECK(relative_error(spring.area, 0.3e-3) < 1e-14);
  CHECK(relative_error(spring.n(), 0.3e9) < 1e-14);
  CHECK(relative_error(spring.s(), 0.6e9) < 1e-14);
}

}  // namespace cdem::test
