// Forces of semi-springs: half the stiffness of the contact's area, no couple, no drift.
#include "core/contact/force/force.hpp"
#include "core/contact/force/spring_force.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/narrow_phase/narrow_phase.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A small box that comes down onto a large fixed one.
struct Landing : Scene {
  Index box;

  explicit Landing(const Vec& velocity) {
    add_box({-1, -1, -1}, {2, 2, 1}, true);
    box = add_box({-0.5, -0.5, 0}, {1, 1, 1});
    build();
    set_interface({{"friction_angle", 0.3}});
    set_motion(box, velocity);
    start();
  }
  /// States of the semi-springs in contact.
  std::vector<ContactState> contacts() const {
    std::vector<ContactState> all;
    for (std::size_t k = 0; k < state.springs.target.size(); ++k)
      if (on_host(state.springs.target)[k] >= 0)
        all.push_back(ContactState::at(state.springs.state.data(), k));
    return all;
  }
};

}  // namespace

TEST_CASE("a corner that sinks in is pressed by half the stiffness of its share of the face") {
  Landing landing({0, 0, -1});
  landing.step(1);  // it moves into contact
  const Real depth = -landing.position(landing.first_node(landing.box)).z;
  REQUIRE(depth > 0);
  landing.step(1);
  const auto contacts = landing.contacts();
  REQUIRE(contacts.size() == 4);
  const Real stiffness = 0.5 * 0.25 * landing.rock.young_modulus();  // of an element of 1 m
  for (const ContactState& c : contacts) {
    CHECK(relative_error(c.penetration, depth) < 3e-14);
    CHECK(relative_error(c.force_n, stiffness * depth) < 3e-14);
    CHECK(relative_error(c.energy_n, 0.5 * stiffness * depth * depth) < 1e-13);
    CHECK(std::abs(c.shear1) + std::abs(c.shear2) < 1e-9);
  }
}

TEST_CASE("a pair that turns as a whole keeps its force: slip is objective") {
  Landing landing({0, 0, -1});
  landing.step(2);
  State& s = landing.state;
  const auto before = landing.contacts();
  // both blocks turn about an axis by the same small angle in one step
  const Vec spin{0.2, -0.1, 0.3};
  const Mat cross_matrix{{0, -spin.z, spin.y}, {spin.z, 0, -spin.x}, {-spin.y, spin.x, 0}};
  const Real angle = 1e-3 * norm(spin);
  const Vec axis = unit(spin);
  Mat turn = Real(std::cos(angle)) * identity<Real>();
  add_outer(turn, Real(1 - std::cos(angle)) * axis, axis);
  turn = turn + Real(std::sin(angle) / norm(spin)) * cross_matrix;
  // where the last step has left them is not where the forces were computed: take it back
  for (Index i = 0; i < landing.model.node_count; ++i) {
    const Vec x = landing.position(i) - s.dt_last * landing.velocity(i);
    const Vec now = turn * x;
    put(landing.motion(i), now);
    put(landing.motion(i) + 4, Real(1 / s.dt_last) * (now - x));
  }
  update_all_face_geometry(landing.model, s, {});
  for (std::size_t k = 0; k < s.springs.target.size(); ++k)
    on_host(s.springs.target_before)[k] = on_host(s.springs.target)[k];
  update_contact_forces(landing.model, s, {});
  const auto after = landing.contacts();
  REQUIRE(after.size() == before.size());
  for (std::size_t k = 0; k < after.size(); ++k) {
    CHECK(relative_error(after[k].force_n, before[k].force_n) < 2e-15);
    CHECK(std::hypot(after[k].shear1, after[k].shear2) < 1e-15 * before[k].force_n);
  }
}

TEST_CASE("contact forces of a body on another sum to no force and no moment") {
  Landing landing({0.5, 0.3, -1});
  for (int n = 0; n < 20; ++n) {
    landing.step(1);
    // the forces were computed where the nodes were before the step's motion
    Vec force{0, 0, 0}, moment{0, 0, 0}, on_box{0, 0, 0};
    const State& s = landing.state;
    for (Index x = 0; x < Index(s.search.exposed_face.size()); ++x) {
      const Index face = on_host(s.search.exposed_face)[x];
      for (Index k = 0; k < 4; ++k) {
        const Index node = on_host(landing.model.face_nodes)[4 * face + k];
        const Vec f = vector_at(s.contact_force.data() + 4 * (4 * x + k));
        force = force + f;
        moment = moment + cross(landing.position(node) - s.dt_last * landing.velocity(node), f);
        if (on_host(landing.model.face_block)[face] == landing.box) on_box = on_box + f;
      }
    }
    CHECK(norm(force) < 1e-15 * (1 + norm(on_box)));
    CHECK(norm(moment) < 1e-15 * (1 + norm(on_box)));
  }
}

TEST_CASE("sliding corners have the friction of Coulomb against their motion") {
  Landing landing({3, 0, -1});
  landing.step(10);
  const auto contacts = landing.contacts();
  REQUIRE(contacts.size() == 4);
  Real friction = 0;
  for (const ContactState& c : contacts)
    CHECK(relative_error(std::hypot(c.shear1, c.shear2), 0.3 * c.force_n) < 1e-12);
  for (std::size_t k = 0; k < landing.state.springs.friction.size(); ++k) {
    CHECK(on_host(landing.state.springs.friction)[k] >= 0);
    friction += on_host(landing.state.springs.friction)[k];
  }
  CHECK(friction > 0);
}

TEST_CASE("semi-springs give the same bits one by one and in lanes") {
  Landing in_lanes({1, 0.5, -1}), one_by_one({1, 0.5, -1});
  in_lanes.step(5);
  one_by_one.step(5);
  const auto ready = [](Landing& landing) {
    update_all_face_geometry(landing.model, landing.state, {});
    find_target_faces(landing.model, landing.state, {});
  };
  ready(in_lanes);
  ready(one_by_one);
  const auto kernel = [](Landing& l) {
    return WithLaws<UpdateSpringForces<ElasticUnloading>, BrittleAlone>{
        {.faces = face_columns(l.model, l.state),
         .geometry = face_geometry(l.state),
         .rules = l.model.rules,
         .laws = contact_laws(l.model, l.state),
         .springs = spring_columns(l.state),
         .history = history_rows(l.state.springs.history)}};
  };
  for_each_selected({}, 12, kernel(in_lanes));
  const auto one = kernel(one_by_one);
  for (Index m = 0; m < 12; ++m)
    for (Index slot = 4 * m; slot < 4 * m + 4; ++slot)
      if (one.selects(m, slot)) one(Selected{m, slot});
  const SpringState &a = in_lanes.state.springs, &b = one_by_one.state.springs;
  for (std::size_t k = 0; k < a.state.size(); ++k) {
    CHECK(same_bits(on_host(a.state)[k], on_host(b.state)[k]));
    CHECK(same_bits(on_host(a.reaction)[k], on_host(b.reaction)[k]));
  }
  for (std::size_t k = 0; k < a.friction.size(); ++k)
    CHECK(same_bits(on_host(a.friction)[k], on_host(b.friction)[k]));
}

}  // namespace cdem::test
