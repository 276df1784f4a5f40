// The law of Barton and Bandis: strength, dilation and closure of a rough joint.
#include <cmath>
#include <string>

#include "core/interfaces/barton_bandis.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

namespace {

constexpr Real kn = 1e12, ks = 1e11;  // [Pa/m]
constexpr Real rad = 0.017453292519943295;

/// jrc, jcs, phi_r, length, uniaxial strength, aperture, factor.
template <class T>
BartonBandis<T> law_of(Real length = 0.1, Real factor = 1) {
  const Real given[] = {10, 50e6, 28, length, 50e6, unlimited, factor};
  const auto row = BartonBandis<Real>::prepare(given);
  return BartonBandis<T>::read([&](Index k) { return T(row[std::size_t(k)]); });
}

/// A joint under a pressure that stays, led along its shear direction.
struct Joint {
  BartonBandis<Real> law;
  Real pressure, at = 0, slipped = 0, slip = 0, shear = 0, risen = 0;
  Real peak = 0, pressed = 0;  // and under which pressure

  void lead_to(Real x, Index steps) {
    const Real begin = at;
    for (Index k = 1; k <= steps; ++k) {
      at = begin + (x - begin) * Real(k) / Real(steps);
      const auto stiffness = JointStiffness<Real>::of(kn, ks);
      JointInput<Real> in = joint_at(-law.depth(pressure, stiffness), at - slipped, kn, ks, 0);
      const JointAnswer<Real> a = law.respond(in, &slip);
      shear = -a.shear1, risen += a.rise, slipped = at - shear / ks;
      if (shear > peak) peak = shear, pressed = a.normal;
    }
  }
};

}  // namespace

TEST_CASE("the peak is sigma tan(JRC log10(JCS / sigma) + phi_r)") {
  for (const Real sigma : {1e5, 5e5, 1e6, 2e6, 5e6, 10e6, 50e6}) {
    Joint joint{.law = law_of<Real>(), .pressure = sigma};
    joint.lead_to(joint.law.peak + 2 * sigma / ks, 20000);
    // it dilates, so that within a step it is pressed a little harder
    CHECK(relative_error(joint.pressed, sigma) < 2e-3);
    const Real angle = std::max(10 * std::log10(50e6 / joint.pressed), 0.0) + 28;
    CHECK(relative_error(joint.peak, joint.pressed * std::tan(rad * angle)) < 2e-5);
  }
}

TEST_CASE("roughness is mobilised with the slip and wears") {
  const Real d = law_of<Real>().peak;
  CHECK(relative_error(d, 0.1 / 500 * std::pow(100.0, 0.33)) < 1e-14);
  const Real place[] = {0.3, 0.6, 1, 2, 4, 10, 25, 100, 1000},
             part[] = {0, 0.75, 1, 0.85, 0.7, 0.5, 0.4, 0, 0};
  for (const Real at : {0.15, 0.29, 0.45, 0.8, 1.5, 3.0, 7.0, 20.0, 50.0, 200.0}) {
    BartonBandis<Real> law = law_of<Real>();
    Real slip = at * d;
    const Real depth = law.depth(1e6, JointStiffness<Real>::of(kn, ks));
    const JointAnswer<Real> a = law.respond(joint_at(-depth, 1.5e-5, kn, ks, 0), &slip);
    const Real x = slip / d;  // at the end of the step
    Real angle = 28 * std::min(x / 0.3, 1.0);
    for (Index k = 0; k < 8; ++k)
      if (x >= place[k] && x < place[k + 1])
        angle += 10 * std::log10(50e6 / a.normal) *
                 (part[k] + (part[k + 1] - part[k]) * (x - place[k]) / (place[k + 1] - place[k]));
    CHECK(x > at);
    CHECK(relative_error(-a.shear1, a.normal * std::tan(rad * angle)) < 1e-4);
  }
}

TEST_CASE("long joints are smoother, softer walls weaker") {
  const BartonBandis<Real> law = law_of<Real>(2);
  CHECK(relative_error(law.jrc, 10 * std::pow(20.0, -0.2)) < 1e-14);
  CHECK(relative_error(law.jcs, 50e6 * std::pow(20.0, -0.3)) < 1e-14);
  CHECK(relative_error(law.peak, 2.0 / 500 * std::pow(law.jrc / 2, 0.33)) < 1e-14);
  CHECK(relative_error(law.closure.initial, 15.35e9) < 1e-14);
  CHECK(relative_error(law.closure.most, 0.227e-3) < 2e-3);
}

TEST_CASE("a factor of safety divides strength and dilation") {
  Real slip = law_of<Real>().peak, other = slip;
  const JointInput<Real> in = joint_at(-1e-4, 1e-2, kn, ks, 0);
  const BartonBandis<Real> whole = law_of<Real>(), half = law_of<Real>(0.1, 2);
  const JointAnswer<Real> a = whole.respond(in, &slip), b = half.respond(in, &other);
  CHECK(b.shear1 / b.normal > a.shear1 / a.normal);  // both are negative
  Joint joint{.law = law_of<Real>(0.1, 2), .pressure = 2e6};
  joint.lead_to(joint.law.peak + 4e6 / ks, 20000);
  CHECK(relative_error(joint.peak, 0.5 * 1.7995e6) < 2e-4);
}

TEST_CASE("it rises by the mobilised dilation, and never by more than its declaration says") {
  Joint joint{.law = law_of<Real>(), .pressure = 1e6};
  joint.lead_to(0.25 * joint.law.peak, 1000);
  CHECK(joint.risen == 0);
  joint.lead_to(joint.law.peak, 20000);
  CHECK(joint.risen > 0);
  Joint free{.law = law_of<Real>(), .pressure = 100};
  free.lead_to(150 * free.law.peak, 200000);
  const Real given[] = {10, 50e6, 28, 0.1, 50e6, unlimited, 1};
  const auto row = BartonBandis<Real>::prepare(given);
  const Real most = BartonBandis<Real>::rise_most(row.data());
  CHECK(free.risen < most);
  CHECK(free.risen > 0.9 * most);
}

TEST_CASE("open it carries nothing and does not slip") {
  Real slip = 0;
  const JointAnswer<Real> a = law_of<Real>().respond(joint_at(1e-4, 1e-3, kn, ks, 0), &slip);
  CHECK(a.normal == 0);
  CHECK(a.shear1 == 0);
  CHECK(slip == 0);
}

TEST_CASE("what does not fit is told") {
  const auto why = [](std::initializer_list<Real> row) {
    const char* text = BartonBandis<Real>::contradiction(row.begin());
    return std::string(text ? text : "");
  };
  CHECK(why({10, 50e6, 28, 0.1, 50e6, unlimited, 1}).empty());
  CHECK(why({0, 50e6, 28, 0.1, 50e6, unlimited, 1}).find("jrc") == 0);
  CHECK(why({10, 0, 28, 0.1, 50e6, unlimited, 1}).find("jcs") == 0);
  CHECK(why({10, 50e6, 28, 0, 50e6, unlimited, 1}).find("joint_length") == 0);
  CHECK(why({10, 50e6, 28, 0.1, 40e6, unlimited, 1}).find("uniaxial_strength") == 0);
  CHECK(why({10, 50e6, 28, 0.1, 50e6, 0, 1}).find("aperture") == 0);
  CHECK(why({0.5, 5e6, 28, 0.1, 50e6, 1e-3, 1}).find("jrc and jcs give no normal") == 0);
  CHECK(why({5, 300e6, 28, 0.1, 300e6, unlimited, 1}).find("jrc and jcs leave no closure") == 0);
}

TEST_CASE("one joint and a lane of them have the same bits") {
  Random random(1);
  check_lanes<9, 6>(
      [](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        T state[] = {in[8]};
        const JointAnswer<T> a = law_of<T>().respond(joint_of(in, kn, ks), state);
        out[0] = a.normal, out[1] = a.shear1, out[2] = a.shear2, out[3] = a.rise;
        out[4] = a.stored_n, out[5] = state[0];
      },
      [&](Real* in) {
        in[0] = random.between(-2e-4, 1e-5);
        in[1] = random.between(-1e-4, 1e-4), in[2] = random.between(-1e-4, 1e-4);
        in[3] = random.between(-1e3, 1e3), in[4] = 0, in[5] = 0, in[6] = 0, in[7] = 1;
        in[8] = random.between(0, 5e-3);
      });
}

}  // namespace cdem::test
