// What a released pair carried goes to the contacts that follow it.
#include <algorithm>
#include <cmath>

#include "core/bonds/transfer_to_contact.hpp"
#include "core/bonds/views.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Two boxes whose bond is broken, the upper pressed into the lower and slid along it.
struct Slid : Scene {
  Vec jump;

  explicit Slid(const Vec& by) : jump(by) {
    bonded = true;
    add_box({0, 0, 0}, {1, 1, 1});
    add_box({0, 0, 1}, {1, 1, 1});
    build();
    start();
    Column<Flag> open = open_faces(state);
    for (const Index side : {0, 1}) on_host(open)[on_host(model.quads.faces)[side]] = 1;
    renew_exposed(model, state, open);
    for (Index i = 8; i < 16; ++i) put(motion(i), position(i) + jump);
  }
  /// Returns the energy that the springs hold  [J].
  Real transfer() {
    Column<Index> pairs;
    pairs.resize(1);  // the only one
    on_host(state.quads.stored)[0] = on_host(state.quads.friction)[0] = 0;
    transfer_to_contact(model, state, model.quads, state.quads, pairs);
    return -on_host(state.quads.friction)[0];
  }
  Index held() const {
    Index count = 0;
    for (std::size_t k = 0; k < state.springs.target.size(); ++k)
      count += on_host(state.springs.target)[k] >= 0;
    return count;
  }
};

}  // namespace

TEST_CASE("both sides take half of the force of a pressed pair, and all of its energy") {
  Slid slid({1e-4, 2e-4, -3e-4});
  const Real energy = slid.transfer();
  const PairSet& p = slid.model.quads;
  const Real k = on_host(p.stiffness)[0] * on_host(p.area)[0];
  CHECK(relative_error(energy, 0.5 * k * dot(slid.jump, slid.jump)) < 1e-12);
  CHECK(slid.held() == 8);
  Real normal = 0;
  for (std::size_t slot = 0; slot < slid.state.springs.target.size(); ++slot) {
    if (on_host(slid.state.springs.target)[slot] < 0) continue;
    const ContactState s = ContactState::at(slid.state.springs.state.data(), slot);
    CHECK(relative_error(s.force_n, k / 8 * 3e-4) < 5e-13);
    CHECK(relative_error(std::hypot(s.shear1, s.shear2), k / 8 * std::hypot(1e-4, 2e-4)) < 5e-13);
    CHECK(on_host(slid.state.springs.target_before)[slot] ==
          on_host(slid.state.springs.target)[slot]);
    normal += s.force_n;
  }
  CHECK(relative_error(normal, k * 3e-4) < 5e-13);
}

TEST_CASE(
    "a softer contact takes what it holds at that depth, a stiffer one all that was carried") {
  for (const Real part : {0.1, 10.0}) {
    Slid slid({1e-4, 2e-4, -3e-4});
    const PairSet& p = slid.model.quads;
    const Real k = on_host(p.stiffness)[0], corner = k * on_host(p.area)[0] / 8;
    Interface& contact = on_host(slid.model.interfaces)[on_host(p.interface)[0]];
    contact.stiffness_n_value = contact.stiffness_s_value = part * k;
    const Real energy = slid.transfer(), taken = std::min(1.0, part), depth = taken / part * 3e-4;
    CHECK(slid.held() == 8);
    for (std::size_t slot = 0; slot < slid.state.springs.target.size(); ++slot) {
      if (on_host(slid.state.springs.target)[slot] < 0) continue;
      const ContactState s = ContactState::at(slid.state.springs.state.data(), slot);
      CHECK(relative_error(s.force_n, taken * corner * 3e-4) < 5e-12);
      CHECK(relative_error(s.penetration, depth) < 5e-12);
      CHECK(relative_error(s.stress_free_gap - depth, -3e-4) < 5e-12);
      CHECK(relative_error(std::hypot(s.shear1, s.shear2), taken * corner * std::sqrt(5e-8)) <
            5e-12);
    }
    const Real carried = taken * taken / part * dot(slid.jump, slid.jump);
    CHECK(relative_error(energy, 0.5 * k * on_host(p.area)[0] * carried) < 1e-11);
  }
}

TEST_CASE("a contact with restitution takes the force, and holds what it can give back") {
  Slid slid({1e-4, 2e-4, -3e-4});
  const PairSet& p = slid.model.quads;
  slid.change_interface(on_host(p.interface)[0],
                        [](Interface& i) { i.returned_n = 0.25, i.returned_s = 0.64; });
  const Real k = on_host(p.stiffness)[0] * on_host(p.area)[0], energy = slid.transfer();
  CHECK(relative_error(energy, 0.5 * k * (0.25 * 9e-8 + 0.64 * 5e-8)) < 1e-11);
  for (std::size_t slot = 0; slot < slid.state.springs.target.size(); ++slot) {
    if (on_host(slid.state.springs.target)[slot] < 0) continue;
    const ContactState s = ContactState::at(slid.state.springs.state.data(), slot);
    CHECK(relative_error(s.force_n, k / 8 * 3e-4) < 5e-12);
    CHECK(s.approach == s.penetration);
  }
}

TEST_CASE("what has slipped already carries no shear") {
  Slid slid({1e-4, 0, -3e-4});
  const PairSet& p = slid.model.quads;
  PairState& bonds = slid.state.quads;
  // along the frame of the first face, whichever way its first side runs
  const Index* n = slid.model.face_nodes.data() + 4 * on_host(p.faces)[0];
  const Vec t1 = unit(slid.position(n[1]) - slid.position(n[0])), t2 = cross(Vec{0, 0, 1}, t1);
  for (Index k = 0; k < 4; ++k) {
    on_host(bonds.slip1)[k * p.point_stride] = dot(t1, slid.jump);
    on_host(bonds.slip2)[k * p.point_stride] = dot(t2, slid.jump);
  }
  const Real k = on_host(p.stiffness)[0] * on_host(p.area)[0];
  CHECK(relative_error(slid.transfer(), 0.5 * k * 9e-8) < 1e-12);
}

TEST_CASE("a pair that has risen hands over all that it carried, at the gap where it did") {
  const Real rise = 3e-4, gap = 1e-4;
  for (const Real part : {0.1, 1.0, 10.0}) {
    Slid slid({2e-4, 0, gap});
    const PairSet& p = slid.model.quads;
    slid.state.quads.rise.resize(slid.state.quads.bond.size(), rise);
    const Real k = on_host(p.stiffness)[0], corner = k * on_host(p.area)[0] / 8;
    Interface& contact = on_host(slid.model.interfaces)[on_host(p.interface)[0]];
    contact.stiffness_n_value = contact.stiffness_s_value = part * k;
    slid.transfer();
    CHECK(slid.held() == 8);
    for (std::size_t slot = 0; slot < slid.state.springs.target.size(); ++slot) {
      if (on_host(slid.state.springs.target)[slot] < 0) continue;
      const ContactState s = ContactState::at(slid.state.springs.state.data(), slot);
      CHECK(relative_error(s.force_n, corner * (rise - gap)) < 5e-12);
      CHECK(relative_error(s.stress_free_gap, gap + (rise - gap) / part) < 5e-12);
      CHECK(relative_error(std::hypot(s.shear1, s.shear2), corner * 2e-4) < 5e-12);
    }
  }
}

TEST_CASE("what a vertex leaves that has slid off goes to its mate, or to the other points") {
  const Real rise = 3e-4;
  for (const Vec& slip : {Vec{8e-3, 0, 0}, Vec{6e-3, 6e-3, 0}}) {
    Slid slid(slip);
    const PairSet& p = slid.model.quads;
    slid.state.quads.rise.resize(slid.state.quads.bond.size(), rise);
    slid.transfer();
    CHECK(slid.held() == (slip.y > 0 ? 2 : 4));
    Real normal = 0;
    for (std::size_t slot = 0; slot < slid.state.springs.target.size(); ++slot)
      normal += ContactState::at(slid.state.springs.state.data(), slot).force_n;
    CHECK(relative_error(normal, on_host(p.stiffness)[0] * on_host(p.area)[0] * rise) < 5e-12);
  }
}

TEST_CASE("an open pair hands nothing over, nor one whose vertices have parted") {
  CHECK(Slid({0, 0, 1e-4}).transfer() == 0);
  Slid parted({0.5, 0, -1e-4});
  CHECK(parted.transfer() == 0);
  CHECK(parted.held() == 0);
}

TEST_CASE("the length of a pair is the smaller of its faces'") {
  const Slid slid({0, 0, 0});
  CHECK(on_host(pair_lengths(slid.model, slid.model.quads)).at(0) ==
        on_host(slid.model.face_length)[on_host(slid.model.quads.faces)[0]]);
}

}  // namespace cdem::test
