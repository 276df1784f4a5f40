// The residual law: brittle, then with what is left of friction and cohesion.
#include <string>

#include "core/interfaces/residual.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

namespace {

constexpr Real kn = 2e9, ks = 1e9;                                                        // [Pa/m]
constexpr Real cohesion = 3e5, tension = 1e5, tan_phi = 0.8, tan_left = 0.5, left = 1e5;  // [Pa]
constexpr Real row[] = {tan_phi, cohesion, tension, 0, 0, tan_left, left};

const Residual<Real> rock = Residual<Real>::read([](Index k) { return row[k]; });

JointAnswer<Real> respond(Real normal, Real shear, Real bond, Real has_area = 1) {
  const JointInput<Real> in{.opening = -normal / kn,
                            .shear1 = -shear / ks,
                            .shear2 = 0,
                            .stiffness = JointStiffness<Real>::of(kn, ks),
                            .damping = 0,
                            .bond = bond,
                            .risen = 0,
                            .has_area = has_area};
  return rock.respond(in, nullptr);
}

}  // namespace

TEST_CASE("a bond has the peak strengths of the brittle law") {
  for (const Real normal : {-0.9e5, 0.0, 2e5}) {
    const Real limit = normal * tan_phi + cohesion;
    CHECK(respond(normal, 0.999999 * limit, 1).bond == 1);
    CHECK(respond(normal, 1.000001 * limit, 1).bond == 0);
  }
  CHECK(respond(-1.01 * tension, 0, 1).opens);
}

TEST_CASE("a broken bond has residual friction, and residual cohesion where it is pressed") {
  for (const Real normal : {1.0, 2e5}) {
    const JointAnswer<Real> a = respond(normal, 9e5, 0);
    CHECK(relative_error(a.shear1, normal * tan_left + left) < 1e-15);
    CHECK(relative_error(a.normal, normal) < 1e-10);
    CHECK(a.bond == 0);
    CHECK(!a.opens);
  }
  const JointAnswer<Real> open = respond(-1, 1e4, 0);
  for (const Real nothing : {open.normal, open.shear1, open.stored_s, open.bond})
    CHECK(nothing == 0);
}

TEST_CASE("a contact has residual friction only") {
  CHECK(relative_error(respond(2e5, 9e5, 0, 0).shear1, 2e5 * tan_left) < 1e-15);
}

TEST_CASE("what is left cannot be more than there was") {
  const auto why = [](Real phi, Real psi, Real phi_left, Real cohesion_left) {
    const Real p[] = {phi, 1e5, 1e5, psi, 1e-3, phi_left, cohesion_left};
    const char* text = Residual<Real>::contradiction(p);
    return std::string(text ? text : "");
  };
  CHECK(why(0.8, 0, 0.5, 1e5).empty());
  CHECK(why(0.8, 0, 0.9, 0).starts_with("residual_friction_angle must not"));
  CHECK(why(0.8, 0.6, 0.5, 0).starts_with("dilation_angle must not be larger than residual"));
  CHECK(why(0.8, 0, 0.5, 2e5).starts_with("residual_cohesion must not"));
}

TEST_CASE("lanes of the residual law are those of its numbers") {
  Random random(1);
  check_lanes<8, 5>(
      [&](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const auto law = Residual<T>::read([](Index k) { return T(row[k]); });
        const JointInput<T> joint = joint_of(in, kn, ks);
        const JointAnswer<T> a = law.respond(joint, nullptr);
        out[0] = a.normal, out[1] = a.shear1, out[2] = a.shear2, out[3] = a.bond, out[4] = a.rise;
      },
      [&](Real* in) {
        for (int k = 0; k < 3; ++k) in[k] = random.between(-3e-4, 3e-4);
        in[3] = in[5] = 0;
        for (int k : {4, 6, 7}) in[k] = random.below(2);
      });
}

}  // namespace cdem::test
