// The continuously yielding joint: it nears its strength, wears, and remembers where it turned.
#include <cmath>
#include <string>

#include "core/interfaces/continuously_yielding.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

namespace {

constexpr Real kn = 1e10, ks = 5e9;  // [Pa/m]
constexpr Real phi = 30, initial = 45, roughness = 2e-3, sigma = 1e6;
constexpr Real rad = 0.017453292519943295;

template <class T>
ContinuouslyYielding<T> law_of(Real factor = 1) {
  const Real row[] = {phi, initial, roughness, factor};
  return ContinuouslyYielding<T>::read([&](Index k) { return T(row[k]); });
}

/// A joint under a pressure that stays, led along its shear direction.
struct Joint {
  ContinuouslyYielding<Real> law = law_of<Real>();
  Real at = 0, shear = 0, risen = 0, work = 0;
  Real state[3] = {0, 0, 0};

  void lead_to(Real x, Index steps) {
    const Real way = (x - at) / Real(steps);
    for (Index k = 0; k < steps; ++k) {
      JointInput<Real> in = joint_at(-sigma / kn, way - shear / ks, kn, ks, 0);
      in.shear1 = way + shear / ks;
      in.dt = 1e-3, in.rate1 = way / in.dt;
      const JointAnswer<Real> a = law.respond(in, state);
      work += -0.5 * (a.shear1 - shear) * way;
      shear = -a.shear1, risen += a.rise;
    }
    at = x;
  }
  Real strength() const {
    return sigma * std::tan(rad * (phi + (initial - phi) * std::exp(-state[0] / roughness)));
  }
};

/// Shear and slip by Cundall and Hart's equations in small steps.
struct Expected {
  Real shear = 0, slip = 0;

  void lead_by(Real way, Index steps, Real r) {
    const Real du = way / Real(steps), sign = way < 0 ? -1 : 1;
    for (Index k = 0; k < steps; ++k) {
      const Real angle = phi + (initial - phi) * std::exp(-slip / roughness);
      const Real f = (1 - sign * shear / (sigma * std::tan(rad * angle))) / (1 - r);
      shear += f * ks * du;
      slip += (1 - f) * std::abs(du);
    }
  }
};

}  // namespace

TEST_CASE("it begins with k_s and nears its strength, which wears with the slip") {
  Joint joint;
  joint.lead_to(1e-8, 1);
  CHECK(relative_error(joint.shear, ks * 1e-8) < 1e-4);
  Expected exact;
  exact.lead_by(1e-3, 1000000, 0);
  joint.lead_to(1e-3, 100000);
  CHECK(relative_error(joint.shear, exact.shear) < 1e-4);
  CHECK(relative_error(joint.state[0], exact.slip) < 1e-4);
  joint.lead_to(8e-3, 20000);
  CHECK(relative_error(joint.shear, joint.strength()) < 5e-3);
  CHECK(joint.shear > joint.strength());
}

TEST_CASE("turned back it is as stiff as at first, and again when it turns before zero") {
  Joint joint;
  Expected exact;
  joint.lead_to(1e-3, 20000), exact.lead_by(1e-3, 500000, 0);
  const Real r = -joint.shear / joint.strength();
  joint.lead_to(0.95e-3, 5000), exact.lead_by(-0.05e-3, 200000, r);
  CHECK(relative_error(joint.shear, exact.shear) < 1e-3);
  CHECK(joint.state[2] == 1);
  const Real again = std::min(joint.shear / joint.strength(), 0.75);
  joint.lead_to(1.0e-3, 5000), exact.lead_by(0.05e-3, 200000, again);
  CHECK(relative_error(joint.shear, exact.shear) < 1e-3);
  CHECK(joint.state[2] == 0);
  CHECK(relative_error(joint.state[1], again) < 1e-2);
}

TEST_CASE("through zero it goes on without a turn") {
  Joint joint;
  Expected exact;
  joint.lead_to(0.3e-3, 20000), exact.lead_by(0.3e-3, 500000, 0);
  const Real r = -joint.shear / joint.strength();
  joint.lead_to(-0.3e-3, 20000), exact.lead_by(-0.6e-3, 500000, r);
  CHECK(joint.shear < 0);
  CHECK(relative_error(joint.shear, exact.shear) < 1e-3);
  CHECK(relative_error(joint.state[1], r) < 1e-2);
}

TEST_CASE("any way it is led, it spends work and bears no more than it could at first") {
  Random random(3);
  Joint joint;
  for (int k = 0; k < 200; ++k) {
    joint.lead_to(random.between(-1e-3, 1e-3), 50);
    CHECK(std::abs(joint.shear) <= sigma * std::tan(rad * initial) * (1 + 1e-12));
    CHECK(joint.work - 0.5 * joint.shear * joint.shear / ks > 0);
  }
}

TEST_CASE("it dilates by atan(tau / sigma) - phi, and no more than its declaration says") {
  Joint joint;
  joint.lead_to(0.1e-3, 2000);
  CHECK(joint.risen == 0);
  joint.lead_to(40e-3, 200000);
  const Real row[] = {phi, initial, roughness, 1};
  const Real most = ContinuouslyYielding<Real>::rise_most(row);
  CHECK(joint.risen < most);
  CHECK(joint.risen > 0.7 * most);
}

TEST_CASE("a factor of safety divides the strength") {
  Joint joint{.law = law_of<Real>(2)};
  joint.lead_to(30e-3, 20000);
  CHECK(relative_error(joint.shear, 0.5 * sigma * std::tan(rad * phi)) < 1e-3);
}

TEST_CASE("led across, it forgets the traction of its old way") {
  Joint joint;
  joint.lead_to(1e-3, 2000);
  Real across = 0;
  for (Index k = 0; k < 2000; ++k) {
    JointInput<Real> in = joint_at(-sigma / kn, joint.shear / ks, kn, ks, 0);
    in.shear2 = 1e-6 + across / ks;
    in.dt = 1e-3, in.rate2 = 1e-3;
    const JointAnswer<Real> a = joint.law.respond(in, joint.state);
    joint.shear = -a.shear1, across = -a.shear2;
  }
  CHECK(std::abs(joint.shear) < 1e-3 * across);
  CHECK(relative_error(across, joint.strength()) < 0.02);
}

TEST_CASE("open or at rest it does not slip") {
  Real state[3] = {0, 0, 0};
  JointInput<Real> in = joint_at(1e-4, 1e-3, kn, ks, 0);
  in.dt = 1e-3, in.rate1 = 1;
  CHECK(law_of<Real>().respond(in, state).shear1 == 0);
  CHECK(state[0] == 0);
  in = joint_at(-1e-4, 1e-5, kn, ks, 0);
  CHECK(relative_error(-law_of<Real>().respond(in, state).shear1, ks * 1e-5) < 1e-14);
  CHECK(state[0] == 0);
}

TEST_CASE("what does not fit is told") {
  const auto why = [](std::initializer_list<Real> row) {
    const char* text = ContinuouslyYielding<Real>::contradiction(row.begin());
    return std::string(text ? text : "");
  };
  CHECK(why({30, 45, 1e-3, 1}).empty());
  CHECK(why({30, 29, 1e-3, 1}).find("initial_friction_angle") == 0);
  CHECK(why({30, 45, 0, 1}).find("roughness") == 0);
}

TEST_CASE("one joint and a lane of them have the same bits") {
  Random random(1);
  check_lanes<11, 7>(
      [](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        T state[] = {in[8], in[9], in[10]};
        JointInput<T> joint = joint_of(in, kn, ks);
        joint.dt = T(1e-3), joint.rate1 = in[5], joint.rate2 = in[6];
        const JointAnswer<T> a = law_of<T>().respond(joint, state);
        out[0] = a.normal, out[1] = a.shear1, out[2] = a.shear2, out[3] = a.rise;
        out[4] = state[0], out[5] = state[1], out[6] = state[2];
      },
      [&](Real* in) {
        in[0] = random.between(-2e-4, 1e-5);
        in[1] = random.between(-1e-4, 1e-4), in[2] = random.between(-1e-4, 1e-4);
        in[3] = random.between(-1e3, 1e3), in[4] = 0, in[7] = 1;
        in[5] = random.between(-1e-2, 1e-2), in[6] = random.between(-1e-2, 1e-2);
        in[8] = random.between(0, 5e-3);
        in[9] = random.between(-1, 0.75), in[10] = Real(random.below(2));
      });
}

}  // namespace cdem::test
