// Force of one contact: spring, dashpot, Coulomb's limit, dilation; and where its energy goes.
#include "core/contact/force/contact_force.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

namespace {

constexpr Real area = 0.25, kn = 2e9, ks = 1e9, dt = 1e-4;
const ContactSpring<Real> spring{.area = area, .stiffness = JointStiffness<Real>::of(kn, ks)};

/// A contact that is led along a path, with its law, and its ledger.
struct Contact {
  Brittle<Real> law;
  Real dashpot = 0;
  Real gap = 0, free = 0;  // of the two points; free of stress
  ContactForce<Real> last{};
  Real work = 0, friction = 0, braked = 0;

  explicit Contact(const Named& named) : law(Joints{named}.law(0)) {}
  void lead(Real gap_now, Real slip1, Real slip2) {
    const ContactMotion<Real> motion{.gap = gap_now - free,
                                     .stress_free_gap = free,
                                     .gap_rate = (gap_now - gap) / dt,
                                     .slip1 = slip1,
                                     .slip2 = slip2,
                                     .dashpot = dashpot,
                                     .dt = dt};
    const ContactBefore<Real> before{last.force_n, last.penetration, last.shear1, last.shear2};
    const ContactForce<Real> f = contact_force(
        spring, motion, before, law.respond(contact_input(spring, motion, before), nullptr));
    work -= 0.5 * ((last.force_n + f.force_n) * (gap_now - gap) + (last.shear1 + f.shear1) * slip1 +
                   (last.shear2 + f.shear2) * slip2);
    friction += f.friction;
    braked += f.dashpot;
    free += f.rise;
    gap = gap_now;
    last = f;
  }
  Real stored() const { return last.energy_n + last.energy_s; }
};

}  // namespace

TEST_CASE("a pressed contact pushes with its stiffness, an open one with nothing") {
  Contact contact({});
  contact.lead(-1e-4, 0, 0);
  CHECK(relative_error(contact.last.force_n, area * kn * 1e-4) < 1e-14);
  CHECK(relative_error(contact.last.energy_n, 0.5 * area * kn * 1e-8) < 1e-14);
  CHECK(contact.last.penetration == 1e-4);
  contact.lead(1e-4, 0, 0);
  CHECK(contact.last.force_n == 0);
  CHECK(contact.last.penetration == 0);
  CHECK(contact.stored() == 0);
}

TEST_CASE("shear grows against the slip up to friction, Coulomb") {
  Contact contact({{"friction_angle", 0.5}});
  contact.lead(-1e-4, 0, 0);
  contact.lead(-1e-4, 3e-5, -4e-5);
  CHECK(relative_error(contact.last.shear1, -area * ks * 3e-5) < 1e-14);
  CHECK(relative_error(contact.last.shear2, area * ks * 4e-5) < 1e-14);
  CHECK(std::abs(contact.friction) < 1e-12);
  contact.lead(-1e-4, 3e-4, -4e-4);
  const Real limit = 0.5 * contact.last.force_n;
  CHECK(relative_error(std::hypot(contact.last.shear1, contact.last.shear2), limit) < 1e-14);
  CHECK(relative_error(contact.last.shear1 * 4, contact.last.shear2 * -3) < 1e-14);
  CHECK(contact.last.friction > 0);
}

TEST_CASE("the dashpot brakes both ways, but never pulls") {
  Contact contact({});
  contact.dashpot = 1e3;
  contact.lead(-1e-4, 0, 0);  // 1 m/s inwards
  CHECK(relative_error(contact.last.force_n, area * kn * 1e-4 + 1e3) < 1e-14);
  CHECK(relative_error(contact.last.energy_n, 0.5 * area * kn * 1e-8) < 1e-14);
  contact.lead(-0.9e-4, 0, 0);
  CHECK(relative_error(contact.last.force_n, area * kn * 0.9e-4 - 1e2) < 1e-13);
  contact.dashpot = 1e9;
  contact.lead(-0.8e-4, 0, 0);
  CHECK(contact.last.force_n == 0);
  CHECK(contact.last.energy_n > 0);
}

TEST_CASE("energies close along any path of a contact that stays pressed") {
  Random random(1);
  for (int round = 0; round < 50; ++round) {
    const bool dilates = round % 2;
    Contact contact(
        {{"friction_angle", 0.5}, {"dilation_angle", dilates ? 0.2 : 0}, {"dilation_slip", 5e-4}});
    contact.dashpot = round % 3 ? 2e3 : 0;
    contact.lead(-2e-4, 0, 0);
    for (int k = 0; k < 200; ++k) {
      contact.lead(-random.between(1e-4, 3e-4), random.between(-1e-4, 1e-4),
                   random.between(-1e-4, 1e-4));
      if (!dilates) CHECK(contact.last.friction > -1e-12);
    }
    const Real lost = contact.friction + contact.braked;
    CHECK(std::abs(contact.work - contact.stored() - lost) < 1e-14 * contact.work);
    CHECK(contact.friction > 0);
    CHECK((contact.braked > 1e-9 * contact.work) == (contact.dashpot > 0));
    CHECK((contact.free > 0) == dilates);
    CHECK(contact.free <= 0.2 * 5e-4);
  }
}

TEST_CASE("a contact that dilates rises by the tangent of its slip, up to its height") {
  Contact contact({{"friction_angle", 0.6}, {"dilation_angle", 0.2}, {"dilation_slip", 1e-3}});
  // held at one gap by a load that does not change: the gap follows the rise
  Real slid = 0;
  contact.lead(-1e-4, 0, 0);
  for (int k = 0; k < 100; ++k) {
    contact.lead(contact.free - 1e-4, 1e-5, 0);
    slid += 1e-5;
  }
  // less the slip that the shear spring holds
  const Real held = -contact.last.shear1 / (area * ks);
  CHECK(contact.free < 0.2 * (slid - held) * (1 + 1e-9));
  for (int k = 0; k < 2000; ++k) contact.lead(contact.free - 1e-4, 1e-5, 0);
  CHECK(relative_error(contact.free, 0.2 * 1e-3) < 1e-9);
}

TEST_CASE(
    "a contact met from outside is free of stress at zero gap, one found inside where it is") {
  // it was at 1e-4 above one step ago, and moves inwards
  CHECK(starting_stress_free_gap(-1e-4, -2e-4 / dt, dt, 0.0, 0.0) == 0);
  // it was 3e-5 inside already
  CHECK(starting_stress_free_gap(-1e-4, -7e-5 / dt, dt, 0.0, 0.0) == doctest::Approx(-3e-5));
  // and takes over from a contact that was 2e-5 deep
  CHECK(starting_stress_free_gap(-1e-4, -7e-5 / dt, dt, 2e-5, 0.0) == doctest::Approx(-1e-5));
  // that had dilated
  CHECK(starting_stress_free_gap(-1e-4, -7e-5 / dt, dt, 1.0, 4e-5) == 4e-5);
}

TEST_CASE("the stress-free gap of a lifted contact follows it to zero; asperities stay") {
  CHECK(lifted_stress_free_gap(-3e-5, -5e-5) == -3e-5);
  CHECK(lifted_stress_free_gap(-3e-5, -1e-5) == -1e-5);
  CHECK(lifted_stress_free_gap(-3e-5, 1e-5) == 0);
  CHECK(lifted_stress_free_gap(2e-5, 5e-5) == 2e-5);
  CHECK(lifted_stress_free_gap(2e-5, -5e-5) == 2e-5);
}

TEST_CASE("a law is asked with the speed of the step's slip") {
  const ContactMotion<Real> motion{.gap = -1e-4,
                                   .stress_free_gap = 0,
                                   .gap_rate = 0,
                                   .slip1 = 3e-5,
                                   .slip2 = -4e-5,
                                   .dashpot = 0,
                                   .dt = dt};
  CHECK(relative_error(contact_input(spring, motion, {}).slip_rate(), 5e-5 / dt) < 1e-14);
}

TEST_CASE("contacts of a lane are those of their numbers") {
  Random random(2);
  check_lanes<13, 9>(
      [](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const ContactSpring<T> own{.area = in[0], .stiffness = JointStiffness<T>::of(in[1], in[2])};
        const ContactMotion<T> motion{in[3], in[4], in[5], in[6], in[7], in[8], dt};
        const ContactBefore<T> before{in[9], in[10], in[11], in[12]};
        const Brittle<T> law{.tan_friction = T(0.5),
                             .cohesion = T(0.0),
                             .tensile_strength = T(0.0),
                             .tan_dilation = T(0.2),
                             .dilation_slip = T(1e-3)};
        const JointAnswer<T> joint = law.respond(contact_input(own, motion, before), nullptr);
        const ContactForce<T> f = contact_force(own, motion, before, joint);
        out[0] = f.force_n, out[1] = f.penetration, out[2] = f.shear1, out[3] = f.shear2;
        out[4] = f.energy_n, out[5] = f.energy_s, out[6] = f.friction, out[7] = f.dashpot;
        out[8] = lifted_stress_free_gap(in[4], in[3]);
      },
      [&](Real* in) {
        in[0] = random.between(0.1, 1), in[1] = kn, in[2] = ks;
        in[3] = random.between(-2e-4, 1e-4), in[4] = random.between(-1e-5, 1e-5);
        in[5] = random.between(-1, 1);
        in[6] = random.between(-1e-4, 1e-4), in[7] = random.between(-1e-4, 1e-4);
        in[8] = random.between(0, 1e4);
        in[9] = random.between(0, 1e5), in[10] = random.between(0, 1e-4);
        in[11] = random.between(-1e4, 1e4), in[12] = random.between(-1e4, 1e4);
      });
}

TEST_CASE("a contact meets its target where it is pressed, and not along the face") {
  const auto meets = [](Real normal, Real shear1, Real shear2) {
    ContactForce<Real> f{};
    f.force_n = normal, f.shear1 = shear1, f.shear2 = shear2;
    return meets_target(f);
  };
  CHECK(meets(1, 0, 0));
  CHECK(meets(1, 5.6, -5.6));  // 83 degrees
  CHECK(!meets(1, 8, 8));
  CHECK(!meets(1e-9, 1, 0));
  CHECK(!meets(0, 0, 0));
}

}  // namespace cdem::test
