// The brittle law: elastic up to the limits of Feng et al. (2014), Eq. 14, then frictional.
#include <string>

#include "core/interfaces/brittle.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

namespace {

constexpr Real kn = 2e9, ks = 1e9;                            // [Pa/m]
constexpr Real cohesion = 3e5, tension = 1e5, tan_phi = 0.5;  // [Pa]

const Brittle<Real> rock =
    Joints{{{"cohesion", cohesion}, {"tensile_strength", tension}, {"friction_angle", tan_phi}}}
        .law(0);

JointInput<Real> at(Real normal, Real shear1, Real shear2 = 0, Real bond = 1) {
  return {.opening = -normal / kn,  // the tractions that an elastic joint would bear
          .shear1 = -shear1 / ks,
          .shear2 = -shear2 / ks,
          .stiffness = JointStiffness<Real>::of(kn, ks),
          .damping = 0,
          .bond = bond,
          .risen = 0,
          .has_area = 1};
}

JointAnswer<Real> respond(const JointInput<Real>& in, const Brittle<Real>& law = rock) {
  return law.respond(in, nullptr);
}

}  // namespace

TEST_CASE("an intact joint is elastic, and stores what it was given") {
  const JointAnswer<Real> a = respond(at(-5e4, 1e5, -2e5));
  CHECK(relative_error(a.normal, -5e4) < 1e-15);
  CHECK(relative_error(a.elastic, -5e4) < 1e-15);
  CHECK(relative_error(a.shear1, 1e5) < 1e-15);
  CHECK(relative_error(a.shear2, -2e5) < 1e-15);
  CHECK(relative_error(a.stored_n, 0.5 * 5e4 * 5e4 / kn) < 1e-15);
  CHECK(relative_error(a.stored_s, 0.5 * (1e10 + 4e10) / ks) < 1e-15);
  CHECK(a.bond == 1);
  CHECK(!a.opens);
}

TEST_CASE("it opens in tension at T, and carries nothing then") {
  constexpr Real round_off = 1e-6 * cohesion;  // that is added to T
  CHECK(respond(at(-(tension + 0.99 * round_off), 0)).bond == 1);
  const JointAnswer<Real> a = respond(at(-(tension + 1.01 * round_off), 1e4));
  CHECK(a.bond == 0);
  CHECK(a.opens);
  for (const Real nothing : {a.normal, a.elastic, a.shear1, a.stored_n, a.stored_s})
    CHECK(nothing == 0);
}

TEST_CASE("it slips in shear at c and the friction of its compression, and breaks with that") {
  for (const Real normal : {0.0, 2e5}) {
    const Real limit = normal * tan_phi + cohesion;
    CHECK(respond(at(normal, 0.999999 * limit)).bond == 1);
    const JointAnswer<Real> a = respond(at(normal, 1.2 * limit));
    CHECK(a.bond == 0);
    CHECK(!a.opens);
    CHECK(relative_error(a.shear1, limit) < 1e-15);
    CHECK(relative_error(a.stored_s, 0.5 * limit * limit / ks) < 1e-14);
    CHECK(std::abs(a.normal - normal) < 1e-10);
  }
}

TEST_CASE("it slips sooner where it is pulled, and lets go at once") {
  const Real normal = -0.9e5, limit = normal * tan_phi + cohesion;
  CHECK(respond(at(normal, 0.999999 * limit)).bond == 1);
  const JointAnswer<Real> a = respond(at(normal, 1.000001 * limit));
  CHECK(a.bond == 0);
  CHECK(!a.opens);
  for (const Real nothing : {a.normal, a.elastic, a.shear1, a.stored_n, a.stored_s})
    CHECK(nothing == 0);
}

TEST_CASE("from the next step on it has friction only") {
  CHECK(relative_error(respond(at(2e5, 3e5, 0, 0)).shear1, 2e5 * tan_phi) < 1e-15);
  CHECK(respond(at(2e5, 0.9e5, 0, 0)).shear1 == doctest::Approx(0.9e5));
  const JointAnswer<Real> open = respond(at(-1, 1e5, 0, 0));
  CHECK(open.normal == 0);
  CHECK(open.shear1 == 0);
}

TEST_CASE("an unloaded joint without tensile strength keeps its cohesion in spite of round-off") {
  const Brittle<Real> law = Joints{{{"cohesion", 1e6}, {"friction_angle", 0.5}}}.law(0);
  CHECK(respond(at(-0.5, 0), law).bond == 1);
  CHECK(respond(at(-2, 0), law).bond == 0);
}

TEST_CASE("whatever the separation, the traction lies within its limits, in its direction") {
  Random random(1);
  for (int k = 0; k < 2000; ++k) {
    const Real bond = random.below(2);
    const JointInput<Real> in =
        at(random.between(-3e5, 3e5), random.between(-6e5, 6e5), random.between(-6e5, 6e5), bond);
    const JointAnswer<Real> a = respond(in);
    const Real shear = std::hypot(a.shear1, a.shear2);
    CHECK(shear <= (1 + 1e-15) * std::max(a.normal * tan_phi + bond * cohesion, 0.0));
    CHECK(-a.normal <= bond * (tension + 1e-6 * cohesion));
    CHECK(a.bond <= bond);
    CHECK(std::abs(a.shear1 * in.shear2 - a.shear2 * in.shear1) <
          1e-15 * shear * std::hypot(in.shear1, in.shear2) + 1e-300);
    CHECK(a.shear1 * in.shear1 + a.shear2 * in.shear2 <= 0);
  }
}

TEST_CASE("bears gives the bits of an intact joint that holds, and tells where it does not") {
  Random random(2);
  Index held = 0;
  for (int k = 0; k < 1000; ++k) {
    const JointInput<Real> in =
        at(random.between(-1.5e5, 3e5), random.between(-3e5, 3e5), random.between(-3e5, 3e5));
    const JointAnswer<Real> a = respond(in);
    const Borne<Real> b = rock.bears(in, nullptr);
    CHECK(b.holds == (a.bond == 1));
    if (!b.holds) continue;
    ++held;
    CHECK(same_bits(b.normal, a.normal));
    CHECK(same_bits(b.shear1, a.shear1));
    CHECK(same_bits(b.shear2, a.shear2));
    CHECK(same_bits(b.stored, a.stored_n + a.stored_s));
  }
  CHECK(held > 200);
}

TEST_CASE("the dashpot of a contact pushes, and never pulls") {
  JointInput<Real> in = at(1e5, 0, 0, 0);
  in.damping = 5e4;
  CHECK(relative_error(respond(in).normal, 1.5e5) < 1e-15);
  CHECK(relative_error(respond(in).elastic, 1e5) < 1e-15);
  in.damping = -3e5;
  CHECK(respond(in).normal == 0);
}

TEST_CASE("a joint that slides rises: limit and rise are solved for at once") {
  constexpr Real tan_psi = 0.2, most = 1e-3;
  const Brittle<Real> law = Joints{
      {{"friction_angle", tan_phi},
       {"dilation_angle", tan_psi},
       {"dilation_slip", most}}}.law(0);
  JointInput<Real> in = at(1e5, 2e5, 0, 0);
  const JointAnswer<Real> a = respond(in, law);
  CHECK(a.rise > 0);
  CHECK(relative_error(a.normal, 1e5 + kn * a.rise) < 1e-14);
  CHECK(relative_error(a.shear1, a.normal * tan_phi) < 1e-14);
  // the slip is what the shear spring gave up
  CHECK(relative_error(a.rise, tan_psi * (2e5 - a.shear1) / ks) < 1e-14);
  in.risen = 0.9999 * tan_psi * most;  // almost at the top of its asperities
  CHECK(relative_error(respond(in, law).rise, 0.0001 * tan_psi * most) < 3e-12);
  in.risen = tan_psi * most;
  CHECK(respond(in, law).rise == 0);
}

TEST_CASE("contradictory parameters are refused") {
  const auto why = [](const Named& named) {
    const char* text = Brittle<Real>::contradiction(brittle_parameters(named).data());
    return std::string(text ? text : "");
  };
  CHECK(why({{"friction_angle", 0.5}}).empty());
  CHECK(why({{"friction_angle", 0.5}, {"dilation_angle", 0.3}, {"dilation_slip", 0.01}}).empty());
  CHECK(why({{"friction_angle", 0.5}, {"dilation_angle", 0.6}, {"dilation_slip", 0.01}})
            .find("friction_angle") != std::string::npos);
  CHECK(why({{"friction_angle", 0.5}, {"dilation_angle", 0.3}}).find("dilation_slip") !=
        std::string::npos);
}

TEST_CASE("the stress-free gap rises at most by the tangent of dilation times its slip") {
  CHECK(Brittle<Real>::rise_most(
            brittle_parameters({{"dilation_angle", 0.2}, {"dilation_slip", 0.01}}).data()) ==
        doctest::Approx(0.002));
}

TEST_CASE("the law answers for a lane what it answers for each joint") {
  Random random(3);
  check_lanes<14, 10>(
      [](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const auto law = Brittle<T>::read([&](Index k) { return in[9 + k]; });
        const JointInput<T> joint{.opening = in[0],
                                  .shear1 = in[1],
                                  .shear2 = in[2],
                                  .stiffness = JointStiffness<T>::of(in[3], in[4]),
                                  .damping = in[5],
                                  .bond = in[6],
                                  .risen = in[7],
                                  .has_area = T(1.0)};
        const JointAnswer<T> a = law.respond(joint, nullptr);
        const Borne<T> b = law.bears(joint, nullptr);
        out[0] = a.elastic, out[1] = a.normal, out[2] = a.shear1, out[3] = a.shear2;
        out[4] = a.stored_n, out[5] = a.stored_s, out[6] = a.rise, out[7] = a.bond;
        out[8] = select(a.opens, T(1.0), T(0.0));
        out[9] = select(b.holds, b.stored, T(-1.0));
      },
      [&](Real* in) {
        in[0] = random.between(-2e-4, 2e-4);
        in[1] = random.between(-2e-4, 2e-4), in[2] = random.between(-2e-4, 2e-4);
        in[3] = kn, in[4] = ks;
        in[5] = random.between(-1e5, 1e5);
        in[6] = random.below(2), in[7] = random.between(0, 1e-4), in[8] = random.below(2);
        in[9] = tan_phi, in[10] = cohesion, in[11] = tension;
        in[12] = random.below(2) * 0.2, in[13] = 1e-3;
      });
}

}  // namespace cdem::test
