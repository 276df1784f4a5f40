// Broken pairs are released to the contact search when they have moved.
#include "core/bonds/release.hpp"
#include "core/diagnostics/energy.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A box bonded to a fixed one below, and thrown.
struct Torn : Scene {
  explicit Torn(const Vec& velocity, Real strength = 1e4) {
    bonded = true;
    add_box({0, 0, 0}, {1, 1, 1}, true);
    const Index box = add_box({0, 0, 1}, {1, 1, 1});
    build();
    set_interface(
        {{"cohesion", strength}, {"tensile_strength", strength}, {"friction_angle", 0.5}});
    set_motion(box, velocity);
    start();
  }
  bool release_is_due() const {
    Answer<Flag> due;
    due.set({}, 0);
    ask_if_release_is_due(model, state, due.data());
    return due.read({}) != 0;
  }
  Real intact() const {
    Real sum = 0;
    for (Index k = 0; k < 4; ++k) sum += on_host(state.quads.bond)[k * model.quads.point_stride];
    return sum;
  }
};

}  // namespace

TEST_CASE("a pair that is torn apart is released, and its faces can be touched") {
  Torn torn({0, 0, 5});
  CHECK(torn.state.search.exposed_face.size() == 10);
  CHECK(!torn.release_is_due());
  torn.step(100);
  CHECK(torn.intact() == 0);
  CHECK(on_host(torn.state.quads.status)[0] == 0);
  CHECK(on_host(torn.state.quads.broken_tension)[0] == 4);
  CHECK(torn.state.search.exposed_face.size() == 12);
  CHECK(torn.velocity(12).z > 4);
}

TEST_CASE("a pair that bears is not released") {
  Torn torn({0, 0, 0.01}, 1e9);
  torn.step(200);
  CHECK(torn.intact() == 4);
  CHECK(on_host(torn.state.quads.status)[0] == 1);
}

TEST_CASE("a pair that is sheared off slides on as a contact, and its energy is accounted for") {
  Torn torn({2, 0, -0.5});
  torn.model.gravity = {0, 0, -10};
  torn.step(150);
  CHECK(on_host(torn.state.quads.status)[0] == 0);
  CHECK(on_host(torn.state.quads.broken_shear)[0] > 0);
  const Energies e = energies(torn.model, torn.state);
  CHECK(e.terms[energy_term("fracture")] > 0);
  CHECK(e.terms[energy_term("friction")] > 0);
  CHECK(std::abs(e.error) < 2e-3);
}

TEST_CASE("broken pairs are due when they have moved by the indentation") {
  Torn torn({0, 0, 0});
  PairState& pairs = torn.state.quads;
  const Real length = on_host(torn.model.face_length)[0];
  on_host(pairs.jump)[0] = 0.9 * torn.model.rules.indentation * length;
  CHECK(!torn.release_is_due());
  on_host(pairs.jump)[0] = 1.1 * torn.model.rules.indentation * length;
  CHECK(torn.release_is_due());
}

}  // namespace cdem::test
