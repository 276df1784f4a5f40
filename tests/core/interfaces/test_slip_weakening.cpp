// The slip-weakening law: brittle, with friction that falls with the slip.
#include <string>

#include "core/interfaces/slip_weakening.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

namespace {

constexpr Real kn = 2e9, ks = 1e9;  // [Pa/m]
constexpr Real peak = 0.7, residual = 0.5, over = 0.01, cohesion = 1e5, tension = 5e4;

template <class T>
SlipWeakening<T> law_of(Real c, Real t) {
  const Real row[] = {peak, c, t, 0, 0, residual, over};
  return SlipWeakening<T>::read([&](Index k) { return T(row[k]); });
}

/// A joint that is pressed and led along its shear direction.
struct Joint {
  SlipWeakening<Real> law = law_of<Real>(0, 0);
  Real normal, stiffness = ks, bond = 0, at = 0, slipped = 0, state = 0, work = 0, shear = 0;

  void lead_to(Real x) {
    const JointInput<Real> in = joint_at(-normal / kn, x - slipped, kn, stiffness, bond);
    const JointAnswer<Real> a = law.respond(in, &state);
    work += 0.5 * (shear - a.shear1) * (x - at);
    shear = -a.shear1, at = x, bond = a.bond;
    slipped = x - shear / stiffness;
  }
};

}  // namespace

TEST_CASE("friction falls in a straight line with the slip, within the step already") {
  for (const Index steps : {10, 1000}) {
    Joint joint{.normal = 1e6};
    for (Index k = 1; k <= steps; ++k) {
      joint.lead_to(0.02 * Real(k) / Real(steps));
      const Real tangent = residual + (peak - residual) * std::max(1 - joint.state / over, 0.0);
      if (joint.state > 0) CHECK(relative_error(joint.shear, 1e6 * tangent) < 1e-12);
    }
    CHECK(relative_error(joint.state, joint.slipped) < 1e-12);
  }
}

TEST_CASE("what it costs beyond residual friction is the triangle under the line") {
  Joint joint{.normal = 1e6};
  for (Index k = 1; k <= 20000; ++k) joint.lead_to(0.02 * k / 20000);
  const Real spent =
      joint.work - 0.5 * joint.shear * joint.shear / ks - residual * 1e6 * joint.state;
  CHECK(relative_error(spent, 1e6 * (peak - residual) * over / 2) < 1e-5);
}

TEST_CASE("a joint that unloads less steeply than its friction falls jumps down") {
  Joint joint{.normal = 1e6, .stiffness = 0.5 * 1e6 * (peak - residual) / over};
  const Real slips = 1e6 * peak / joint.stiffness;
  joint.lead_to(0.999 * slips);
  CHECK(joint.state == 0);
  joint.lead_to(1.001 * slips);
  CHECK(joint.state > over);
  CHECK(relative_error(joint.shear, 1e6 * residual) < 1e-12);
}

TEST_CASE("a bond has not slipped until it breaks, and its slip counts from then") {
  Joint joint{.law = law_of<Real>(cohesion, tension), .normal = 1e6, .bond = 1};
  const Real limit = 1e6 * peak + cohesion;
  joint.lead_to(0.999 * limit / ks);
  CHECK(joint.state == 0);
  CHECK(joint.bond == 1);
  joint.lead_to(1.001 * limit / ks);
  CHECK(joint.bond == 0);
  CHECK(joint.state > 0);
  CHECK(joint.shear < limit);
}

TEST_CASE("an open joint does not slip") {
  Joint joint{.normal = -1e5};
  joint.lead_to(0.01);
  CHECK(joint.shear == 0);
  CHECK(joint.state == 0);
}

TEST_CASE("a fall over no slip is refused") {
  const auto why = [](Real phi_left, Real over) {
    const Real p[] = {0.7, 0, 0, 0, 0, phi_left, over};
    const char* text = SlipWeakening<Real>::contradiction(p);
    return std::string(text ? text : "");
  };
  CHECK(why(0.5, 1).empty());
  CHECK(why(0.5, 0).starts_with("slip_distance"));
  CHECK(why(0.8, 1).starts_with("residual_friction_angle"));
}

TEST_CASE("lanes of the slip-weakening law are those of its numbers") {
  Random random(1);
  check_lanes<9, 6>(
      [&](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const JointInput<T> joint = joint_of(in, kn, ks);
        T state = in[8];
        const JointAnswer<T> a = law_of<T>(cohesion, tension).respond(joint, &state);
        out[0] = a.normal, out[1] = a.shear1, out[2] = a.shear2, out[3] = a.bond, out[4] = a.rise;
        out[5] = state;
      },
      [&](Real* in) {
        for (int k = 0; k < 3; ++k) in[k] = random.between(-2e-3, 2e-3);
        in[3] = in[5] = 0;
        for (int k : {4, 6, 7}) in[k] = random.below(2);
        in[8] = in[4] > 0 ? 0 : random.between(0, 2 * over);
      });
}

}  // namespace cdem::test
