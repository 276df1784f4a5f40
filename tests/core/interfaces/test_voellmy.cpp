// The law of Voellmy: brittle, with friction that grows with the square of the speed.
#include "core/interfaces/voellmy.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

namespace {

constexpr Real kn = 2e9, ks = 1e9;  // [Pa/m]
constexpr Real tangent = 0.15, turbulence = 500, density = 2000, cohesion = 1e5, tension = 5e4;
const Voellmy<Real> law = [] {
  const Real row[] = {tangent, cohesion, tension, 0, 0, turbulence, density};
  return Voellmy<Real>::read([&](Index k) { return row[k]; });
}();

JointInput<Real> sliding(Real opening, Real shear, Real bond) {
  JointInput<Real> in = joint_at(opening, shear, kn, ks, bond);
  in.rate1 = 12, in.rate2 = 16;  // 20 m/s
  return in;
}

}  // namespace

TEST_CASE("mu sigma + rho g v^2 / xi where it slides; no more than its spring bears") {
  const Real turbulent = density * 9.81 * 400 / turbulence;
  const Real limit = tangent * 1e6 + turbulent;
  CHECK(relative_error(-law.respond(sliding(-1e6 / kn, 1, 0), nullptr).shear1, limit) < 1e-14);
  const Real strained = 0.9 * limit / ks;
  CHECK(relative_error(-law.respond(sliding(-1e6 / kn, strained, 0), nullptr).shear1, 0.9 * limit) <
        1e-14);
  // free of stress, but in touch; and lifted
  CHECK(relative_error(-law.respond(sliding(0, 1, 0), nullptr).shear1, turbulent) < 1e-14);
  CHECK(law.respond(sliding(1e-6, 1, 0), nullptr).shear1 == 0);
}

TEST_CASE("a bond that holds knows no speed") {
  const Real limit = tangent * 1e6 + cohesion;
  CHECK(relative_error(-law.respond(sliding(-1e6 / kn, 1, 1), nullptr).shear1, limit) < 1e-14);
}

}  // namespace cdem::test
