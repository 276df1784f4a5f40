// Forces of semi-edges: along the common perpendicular, on one line of action.
#include "core/contact/force/edge_force.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Two ridges that cross under an angle; the upper comes down onto the lower, which is fixed.
struct DroppedRidges : Scene {
  DroppedRidges() {
    add<Wedge6>({{{1, -2, -1}, {-1, -2, -1}, {0, -2, 0}, {1, 2, -1}, {-1, 2, -1}, {0, 2, 0}}},
                true);
    const Real s = std::sin(1.2), c = std::cos(1.2);
    const auto turned = [&](Real x, Real y, Real z) {
      return Vec{c * x - s * y, s * x + c * y + 0.3, z};
    };
    add<Wedge6>({{turned(-1, -2, 1), turned(1, -2, 1), turned(0, -2, 0), turned(-1, 2, 1),
                  turned(1, 2, 1), turned(0, 2, 0)}});
    build();
    set_interface({{"friction_angle", 0.3}});
  }
  void drop(const Vec& velocity) {
    set_motion(1, velocity);
    start();
  }
  Index contacts() const { return Index(state.edges.contact.size() / 4); }
  ContactState contact(Index c) const { return ContactState::at(state.edges.state.data(), c); }
  const Real* reaction(Index c) const { return state.edges.reaction.data() + 8 * c; }
};

}  // namespace

TEST_CASE("ridges that cross are pressed apart along their common perpendicular") {
  DroppedRidges ridges;
  ridges.drop({0, 0, -1});
  ridges.step(2);
  REQUIRE(ridges.contacts() == 4);
  for (Index c = 0; c < 4; ++c) {
    const ContactState s = ridges.contact(c);
    CHECK(s.force_n > 0);
    CHECK(s.penetration > 0);
    CHECK(relative_error(s.energy_n, 0.5 * s.force_n * s.penetration) < 1e-12);
    const Real* force = ridges.reaction(c);
    CHECK(relative_error(std::abs(force[2]), s.force_n) < 1e-12);
    CHECK(std::hypot(force[0], force[1]) < 1e-12 * s.force_n);
    const bool upper =
        on_host(
            ridges.model
                .face_block)[EdgeContact::at(ridges.state.edges.contact.data(), c).mother / 4] == 1;
    CHECK((force[2] > 0) == upper);
    CHECK(force[4] > 0);  // places on the two sides
    CHECK(force[4] < 1);
    CHECK(force[5] > 0);
    CHECK(force[5] < 1);
  }
}

TEST_CASE("edges that slide have Coulomb's friction, and lose energy") {
  DroppedRidges ridges;
  ridges.drop({0, 2, -1});
  ridges.step(10);
  REQUIRE(ridges.contacts() == 4);
  Real friction = 0;
  for (Index c = 0; c < 4; ++c) {
    const ContactState s = ridges.contact(c);
    CHECK(std::hypot(s.shear1, s.shear2) < (1 + 1e-12) * 0.3 * s.force_n);
    CHECK(std::hypot(s.shear1, s.shear2) > 0.1 * s.force_n);
  }
  for (std::size_t x = 0; x < ridges.state.edges.friction.size(); ++x)
    friction += on_host(ridges.state.edges.friction)[x];
  CHECK(friction > 0);
}

TEST_CASE("forces of crossing edges sum to no force and no moment") {
  DroppedRidges ridges;
  ridges.drop({0.5, 1, -1});
  for (int n = 0; n < 10; ++n) {
    ridges.step(1);
    Vec force{0, 0, 0}, moment{0, 0, 0};
    Real size = 0;
    const State& s = ridges.state;
    for (Index x = 0; x < Index(s.search.exposed_face.size()); ++x)
      for (Index k = 0; k < on_host(s.search.exposed)[x].count(); ++k) {
        const Index node = on_host(s.search.exposed)[x].corner[k];
        const Vec f = vector_at(s.contact_force.data() + 4 * (4 * x + k));
        force = force + f;
        moment = moment + cross(ridges.position(node) - s.dt_last * ridges.velocity(node), f);
        size += norm(f);
      }
    CHECK(norm(force) < 5e-16 * (1 + size));
    CHECK(norm(moment) < 1e-15 * (1 + size));
  }
}

}  // namespace cdem::test
