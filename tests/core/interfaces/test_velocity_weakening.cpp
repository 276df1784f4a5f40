// The velocity-weakening law: brittle, with friction that falls with the speed of slip.
#include "core/interfaces/velocity_weakening.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

namespace {

constexpr Real kn = 2e9, ks = 1e9;  // [Pa/m]
constexpr Real at_rest = 0.7, dynamic = 0.5, velocity = 0.1, cohesion = 1e5, tension = 5e4;

template <class T>
VelocityWeakening<T> law() {
  const Real row[] = {at_rest, cohesion, tension, 0, 0, dynamic, velocity};
  return VelocityWeakening<T>::read([&](Index k) { return T(row[k]); });
}

}  // namespace

TEST_CASE("friction of a broken joint falls with the speed along both axes") {
  for (const Real speed : {0.0, 0.03, 0.1, 10.0}) {
    JointInput<Real> in = joint_at(-1e6 / kn, 1, kn, ks, 0);
    in.rate1 = 0.6 * speed, in.rate2 = -0.8 * speed;
    const Real tangent = dynamic + (at_rest - dynamic) / (1 + speed / velocity);
    CHECK(relative_error(-law<Real>().respond(in, nullptr).shear1, 1e6 * tangent) < 1e-14);
  }
}

TEST_CASE("a bond has the friction of rest") {
  JointInput<Real> in = joint_at(-1e6 / kn, 1, kn, ks, 1);
  in.rate1 = 10;
  CHECK(relative_error(-law<Real>().respond(in, nullptr).shear1, 1e6 * at_rest + cohesion) < 1e-14);
}

TEST_CASE("joints of a lane with rates are those of their numbers") {
  Random random(1);
  check_lanes<8, 2>(
      [](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        JointInput<T> joint = joint_of(in, kn, ks);
        joint.rate1 = in[6], joint.rate2 = in[5];
        const JointAnswer<T> a = law<T>().respond(joint, nullptr);
        out[0] = a.shear1, out[1] = a.bond;
      },
      [&](Real* in) {
        in[0] = random.between(-1e-3, 1e-4), in[1] = random.between(-1e-3, 1e-3);
        in[2] = random.between(-1e-3, 1e-3), in[3] = 0, in[4] = random.below(2);
        in[5] = random.between(0, 1), in[6] = random.between(-1, 1), in[7] = random.below(2);
      });
}

}  // namespace cdem::test
