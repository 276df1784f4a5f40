// What a contact that ended did not give back.
#include "core/contact/narrow_phase/closed_contact.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

const Frame<Real> frame{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};

ContactState loaded() {
  constexpr Real stiffness = 1e6, penetration = 1e-3;
  return {.force_n = stiffness * penetration,
          .penetration = penetration,
          .shear1 = 300,
          .shear2 = 0,
          .stress_free_gap = 0,
          .energy_n = 0.5 * stiffness * penetration * penetration,
          .energy_s = 0.5 * 300 * 300 / stiffness};
}

}  // namespace

TEST_CASE("springs that relaxed in the last step gave all back") {
  // in the last step the force fell to zero: half of it did the work
  const DissipatedAtEnd lost(loaded(), 1, frame, Vec{300 / 1e6, 0, 1e-3});
  CHECK(std::abs(lost.dashpot) < 1e-18);
  CHECK(std::abs(lost.friction) < 1e-18);
}

TEST_CASE("the normal spring gives back no more than until it is free of stress") {
  CHECK(std::abs(DissipatedAtEnd(loaded(), 1, frame, Vec{0, 0, 1}).dashpot) < 1e-18);
}

TEST_CASE("a hysteretic spring is free of stress after e^2 of its penetration") {
  ContactState state = loaded();
  state.energy_n *= 0.25;
  CHECK(std::abs(DissipatedAtEnd(state, 0.25, frame, Vec{0, 0, 1}).dashpot) < 1e-18);
  const DissipatedAtEnd lost(state, 0.25, frame, Vec{0, 0, 1e-4});
  CHECK(lost.dashpot == doctest::Approx(state.energy_n - 0.5 * state.force_n * 1e-4));
}

TEST_CASE("what was still held when a vertex slid off is lost") {
  const DissipatedAtEnd lost(loaded(), 1, frame, Vec{0, 5e-3, 0});
  CHECK(lost.dashpot == loaded().energy_n);
  CHECK(lost.friction == loaded().energy_s);
}

}  // namespace cdem::test
