// Contacts that give back e^2 of what loading put in: normal, shear, along any path.
#include "core/contact/force/unloading.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

namespace {

constexpr Real area = 0.25, kn = 2e9, ks = 1e9, dt = 1e-4;
const ContactSpring<Real> spring{.area = area, .stiffness = JointStiffness<Real>::of(kn, ks)};
const Named rough{{"friction_angle", 0.5}, {"dilation_angle", 0.2}, {"dilation_slip", 5e-4}};

/// A contact that is led along a path, with its law, and its ledger.
template <template <class> class Unloading, class Law = Brittle<Real>>
struct Contact {
  Unloading<Real> unloading;
  Law law;
  Real state[InterfaceLaws::most_state] = {};
  Real dashpot = 0;
  Real gap = 0, free = 0, approach = 0;
  ContactForce<Real> last{};
  Real work = 0, friction = 0, braked = 0;

  Contact(const Unloading<Real>& unloading, const Named& named)
      : unloading(unloading), law(Joints{named}.law(0)) {}
  Contact(const Unloading<Real>& unloading, const Law& law) : unloading(unloading), law(law) {}
  void lead(Real gap_now, Real slip1 = 0, Real slip2 = 0) {
    const ContactBefore<Real> before{last.force_n, last.penetration, last.shear1, last.shear2,
                                     approach};
    free = lifted_stress_free_gap(free, gap_now);
    const ContactMotion<Real> motion{.gap = unloading.gap(gap_now - free, before),
                                     .stress_free_gap = free,
                                     .gap_rate = (gap_now - gap) / dt,
                                     .slip1 = slip1,
                                     .slip2 = slip2,
                                     .dashpot = dashpot,
                                     .dt = dt};
    const ContactForce<Real> f =
        unloading.force(spring, motion, gap_now - free, before,
                        law.respond(unloading.input(spring, motion, before), state));
    work -= 0.5 * ((last.force_n + f.force_n) * (gap_now - gap) + (last.shear1 + f.shear1) * slip1 +
                   (last.shear2 + f.shear2) * slip2);
    friction += f.friction;
    braked += f.dashpot;
    approach = unloading.approach(gap_now - free, f);
    free += f.rise;
    gap = gap_now;
    last = f;
  }
  Real stored() const { return last.energy_n + last.energy_s; }
};
using Hysteretic = Contact<HystereticUnloading>;
using Closing = Contact<HystereticUnloading, BartonBandis<Real>>;

BartonBandis<Real> soft_joint() {
  constexpr Real given[] = {10, 50e6, 28, 0.1, 50e6, unlimited, 1};
  const auto row = BartonBandis<Real>::prepare(given);
  return BartonBandis<Real>::read([&](Index k) { return row[std::size_t(k)]; });
}

}  // namespace

TEST_CASE("a contact that closes by a curve keeps its depth and gives back what it took") {
  Closing contact({.returned_n = 1, .returned_s = 1, .curved = true}, soft_joint());
  contact.law.closure = {.initial = 1e8, .most = 1e-3};
  for (int k = 1; k <= 1000; ++k) contact.lead(-0.6e-6 * k);
  const Real force = area * 1e8 * 0.6e-3 / 0.4;
  CHECK(relative_error(contact.last.force_n, force) < 1e-13);
  CHECK(relative_error(contact.last.penetration, force / (area * kn)) < 1e-13);
  CHECK(relative_error(contact.approach, 0.6e-3) < 1e-13);
  CHECK(relative_error(contact.stored(), contact.work) < 1e-5);
  const Real put_in = contact.work;
  for (int k = 1; k <= 1000; ++k) contact.lead(-0.6e-6 * (1000 - k));
  CHECK(std::abs(contact.work) < 1e-12 * put_in);
  CHECK(std::abs(contact.braked) < 1e-12 * put_in);
}

TEST_CASE("a contact gives back e^2 of the work of loading, normal") {
  for (const Real e : {0.1, 0.5, 0.9}) {
    Hysteretic contact({e * e, 1}, {});
    contact.lead(-1e-3);
    const Real put_in = contact.work;
    CHECK(relative_error(contact.last.force_n, area * kn * 1e-3) < 1e-14);
    CHECK(relative_error(contact.last.energy_n, e * e * put_in) < 1e-14);
    for (int k = 1; k <= 100; ++k) contact.lead(-1e-3 * (1 - e * e * k / 100));
    CHECK(contact.last.force_n < 1e-12 * area * kn * 1e-3);
    CHECK(relative_error(contact.work, (1 - e * e) * put_in) < 1e-12);
    CHECK(relative_error(contact.braked, contact.work) < 1e-12);
  }
}

TEST_CASE("a contact reloads as stiff as it unloaded, until it is as deep as it was") {
  Hysteretic contact({0.25, 1}, {});
  contact.lead(-1e-3);
  contact.lead(-0.9e-3);
  CHECK(relative_error(contact.last.force_n, area * kn * 0.6e-3) < 1e-13);
  contact.lead(-0.95e-3);
  CHECK(relative_error(contact.last.force_n, area * kn * 0.8e-3) < 1e-13);
  contact.lead(-1.1e-3);
  CHECK(relative_error(contact.last.force_n, area * kn * 1.1e-3) < 1e-13);
}

TEST_CASE("a contact without force that moves outwards loads again from where it turns") {
  Hysteretic contact({0.25, 1}, {});
  contact.lead(-1e-3);
  contact.lead(-0.5e-3);
  CHECK(contact.last.force_n == 0);
  contact.lead(-0.4e-3);
  contact.lead(-0.5e-3);
  CHECK(relative_error(contact.last.force_n, area * kn * 0.4e-3) < 1e-13);
  contact.lead(1e-3);
  contact.lead(-0.1e-3);
  CHECK(relative_error(contact.last.force_n, area * kn * 0.1e-3) < 1e-13);
}

TEST_CASE("a contact that began inside follows back, and its approach starts again") {
  Hysteretic contact({0.25, 1}, {});
  contact.free = contact.gap = -1e-3;
  contact.lead(-1.2e-3);
  contact.lead(-1.1e-3);
  CHECK(contact.last.force_n == 0);
  CHECK(contact.approach == doctest::Approx(0.1e-3));
  contact.lead(-0.7e-3);
  CHECK(contact.free == -0.7e-3);
  CHECK(contact.approach == 0);
  contact.lead(-0.8e-3);
  CHECK(relative_error(contact.last.force_n, area * kn * 0.1e-3) < 1e-12);
}

TEST_CASE("energies close along any path of a hysteretic contact that stays pressed") {
  Random random(1);
  for (int round = 0; round < 60; ++round) {
    Hysteretic contact({random.between(0.01, 1), random.between(0.01, 1)}, rough);
    if (round % 2 == 0) contact.law.tan_dilation = 0;
    contact.dashpot = round % 3 ? 2e3 : 0;
    contact.lead(-2e-4);
    for (int k = 0; k < 200; ++k) {
      const Real before = contact.braked;
      contact.lead(contact.gap + random.between(-1, 1) * 0.2 * contact.last.penetration *
                                     contact.unloading.returned_n,
                   random.between(-1e-4, 1e-4), random.between(-1e-4, 1e-4));
      if (!contact.dashpot) CHECK(contact.braked >= before * (1 - 1e-14));  // but for rounding
      REQUIRE(contact.last.penetration > 0);
    }
    const Real lost = contact.friction + contact.braked;
    CHECK(std::abs(contact.work - contact.stored() - lost) < 1e-13 * contact.work);
  }
}

TEST_CASE("no path in and out takes more from a contact than was put in") {
  Random random(3);
  for (int round = 0; round < 100; ++round) {
    const Real returned = random.between(0.01, 1);
    Hysteretic contact({returned, 1}, {});
    contact.free = contact.gap = round % 2 ? -2e-4 : 0;
    Real out = 0;
    for (int k = 0; k < 500; ++k) {
      // small steps: the work of a step's mean force is exact within a branch
      const Real way = random.between(-1e-4, 1e-4);
      const Real start = contact.gap;
      for (int j = 1; j <= 100; ++j) contact.lead(start + way * j / 100);
      out = min_of(out, contact.work - contact.stored());
      CHECK(contact.braked >= 0);
    }
    CHECK(out > -1e-4 * contact.braked - 1e-12);
  }
}

TEST_CASE("shear gives back e^2 of the work of loading") {
  for (const Real e : {0.1, 0.5, 0.9}) {
    Hysteretic contact({1, e * e}, {{"friction_angle", 10}});
    contact.lead(-1e-3);
    const Real pressed = contact.work;
    contact.lead(-1e-3, 3e-4, -4e-4);
    const Real put_in = contact.work - pressed;
    CHECK(relative_error(contact.last.shear1, -area * ks * 3e-4) < 1e-13);
    CHECK(relative_error(contact.last.energy_s, e * e * put_in) < 1e-13);
    for (int k = 0; k < 50; ++k) contact.lead(-1e-3, -6e-6 * e * e, 8e-6 * e * e);
    CHECK(std::abs(contact.last.shear1) < 1e-9 * area * ks);
    CHECK(relative_error(contact.work - pressed, (1 - e * e) * put_in) < 1e-11);
    CHECK(relative_error(contact.friction, (1 - e * e) * put_in) < 1e-11);
    // past no force it loads the other way
    contact.lead(-1e-3, -3e-6, 4e-6);
    CHECK(contact.last.shear1 > 0);
    contact.lead(-1e-3, -3e-4, 4e-4);
    CHECK(relative_error(contact.last.shear1, area * ks * 3e-4) < 0.05);
  }
}

TEST_CASE("shear across the old force loads with the stiffness of loading") {
  const ShearForce<Real> f = hysteretic_shear<Real>(0.25, 2.0, {3.0, 4.0}, 0.08, -0.06);
  CHECK(f.f1 == doctest::Approx(3 - 2 * 0.08));
  CHECK(f.f2 == doctest::Approx(4 + 2 * 0.06));
}

TEST_CASE("no slip, however large, takes more from a shear spring than was put in") {
  Random random(4);
  for (int round = 0; round < 100; ++round) {
    Hysteretic contact({1, random.between(0.01, 1)}, {{"friction_angle", 1e3}});
    contact.lead(-1e-3);
    const Real size = round % 2 ? 1e-3 : 1e-6;
    for (int k = 0; k < 200; ++k) {
      const Real before = contact.friction;
      contact.lead(-1e-3, random.between(-size, size), random.between(-size, size));
      CHECK(contact.friction >= before - 1e-12 * contact.work);
    }
  }
}

TEST_CASE("a coefficient of 1 is an elastic contact, to the bit") {
  Random random(5);
  Hysteretic a({1, 1}, rough);
  Contact<ElasticUnloading> b({}, rough);
  a.dashpot = b.dashpot = 2e3;
  for (int k = 0; k < 1000; ++k) {
    const Real gap = random.between(-3e-4, 1e-4), slip1 = random.between(-1e-4, 1e-4),
               slip2 = random.between(-1e-4, 1e-4);
    a.lead(gap, slip1, slip2);
    b.lead(gap, slip1, slip2);
    CHECK(same_bits(a.last.force_n, b.last.force_n));
    CHECK(same_bits(a.last.penetration, b.last.penetration));
    CHECK(same_bits(a.last.shear1, b.last.shear1));
    CHECK(same_bits(a.last.energy_n, b.last.energy_n));
    CHECK(same_bits(a.last.energy_s, b.last.energy_s));
    CHECK(same_bits(a.friction, b.friction));
    CHECK(same_bits(a.braked, b.braked));
  }
}

TEST_CASE("a contact that moves to another face is no deeper than it is there") {
  const HystereticUnloading<Real> unloading{0.25, 1};
  ContactBefore<Real> before{1e4, 2e-4, 0, 0, 8e-4};
  unloading.begin(true, 4e-4, before);
  CHECK(before.approach == doctest::Approx(4e-4));
  CHECK(before.penetration == doctest::Approx(1e-4));
  unloading.begin(true, -1e-4, before);
  CHECK(before.approach == 0);
  CHECK(before.penetration == 0);
  ContactBefore<Real> goes_on{1e4, 2e-4, 0, 0, 8e-4};
  unloading.begin(false, 4e-4, goes_on);
  CHECK(goes_on.approach == 8e-4);
  CHECK(goes_on.penetration == 2e-4);
}

TEST_CASE("hysteretic contacts of a lane are those of their numbers") {
  Random random(2);
  check_lanes<16, 9>(
      [](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const ContactSpring<T> own{.area = in[0], .stiffness = JointStiffness<T>::of(in[1], in[2])};
        const HystereticUnloading<T> unloading{in[8], in[9]};
        ContactBefore<T> before{in[10], in[11], in[12], in[13], in[14]};
        unloading.begin(in[15] > T(0.5), in[4], before);
        const T zero(0.0);
        const ContactMotion<T> motion{.gap = unloading.gap(in[3], before),
                                      .stress_free_gap = zero,
                                      .gap_rate = in[5],
                                      .slip1 = in[6],
                                      .slip2 = in[7],
                                      .dashpot = T(1e3),
                                      .dt = dt};
        const Brittle<T> law{.tan_friction = T(0.5),
                             .cohesion = zero,
                             .tensile_strength = zero,
                             .tan_dilation = zero,
                             .dilation_slip = zero};
        const JointAnswer<T> joint = law.respond(unloading.input(own, motion, before), nullptr);
        const ContactForce<T> f = unloading.force(own, motion, in[3], before, joint);
        out[0] = f.force_n, out[1] = f.penetration, out[2] = f.shear1, out[3] = f.shear2;
        out[4] = f.energy_n, out[5] = f.energy_s, out[6] = f.friction, out[7] = f.dashpot;
        out[8] = unloading.stiffness(own);
      },
      [&](Real* in) {
        in[0] = random.between(0.1, 1), in[1] = kn, in[2] = ks;
        in[3] = random.between(-2e-4, 1e-4), in[4] = random.between(-1e-4, 1e-4);
        in[5] = random.between(-1, 1);
        in[6] = random.between(-1e-4, 1e-4), in[7] = random.between(-1e-4, 1e-4);
        in[8] = random.below(3) ? random.between(0.01, 1) : 1;
        in[9] = random.below(3) ? random.between(0.01, 1) : 1;
        in[10] = random.between(0, 1e5), in[11] = random.between(0, 1e-4);
        in[12] = random.below(4) ? random.between(-1e4, 1e4) : 0;
        in[13] = random.below(4) ? random.between(-1e4, 1e4) : 0;
        in[14] = in[11] + random.between(0, 1e-4), in[15] = random.below(2);
      });
}

}  // namespace cdem::test
