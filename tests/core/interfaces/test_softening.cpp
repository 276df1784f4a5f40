// The softening law: linear, with the fracture energies of both modes, in any mix of them.
#include <numbers>
#include <string>

#include "core/interfaces/softening.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

namespace {

constexpr Real kn = 3e12, ks = 2e12, tension = 3e6, cohesion = 6e6, energy_1 = 100, energy_2 = 300;

struct Rock {
  Real phi = 0, phi_left = 0, over = 0, cohesion_left = 0;  // tangents, [m], [Pa]
};
template <class T>
Softening<T> law_of(const Rock& rock) {
  const Real row[] = {rock.phi,  cohesion,           tension,  0,       0, rock.phi_left,
                      rock.over, rock.cohesion_left, energy_1, energy_2};
  return Softening<T>::read([&](Index k) { return T(row[k]); });
}

/// A bonded joint that is led through separations, and what that costs.
struct Joint {
  Softening<Real> law;
  Real state[3] = {0, 0, 0}, bond = 1, slipped = 0, opening = 0, shear = 0;
  Real work_n = 0, work_s = 0, fracture = 0, friction = 0;
  JointAnswer<Real> last{};

  void lead_to(Real n, Real s) {
    const JointInput<Real> in = joint_at(n, s - slipped, kn, ks, bond);
    const JointAnswer<Real> a = law.respond(in, state);
    work_n -= 0.5 * (last.normal + a.normal) * (n - opening);
    work_s -= 0.5 * (last.shear1 + a.shear1) * (s - shear);
    fracture += a.fracture, friction += a.friction;
    slipped = s + a.shear1 / ks;
    opening = n, shear = s, bond = a.bond, last = a;
  }
  void walk_to(Real n, Real s, Index steps) {
    const Real n0 = opening, s0 = shear;
    for (Index k = 1; k <= steps && bond > 0; ++k)
      lead_to(n0 + (n - n0) * k / steps, s0 + (s - s0) * k / steps);
  }
  Real stored() const { return last.stored_n + last.stored_s; }
};

}  // namespace

TEST_CASE("on a straight way of any direction the parts of the fracture energies sum to one") {
  for (const Real angle : {0.0, 20.0, 45.0, 70.0, 90.0}) {
    Joint joint{law_of<Real>({})};
    const Real a = angle * std::numbers::pi / 180;
    joint.walk_to(angle == 90 ? 0 : 4e-4 * std::cos(a), 4e-4 * std::sin(a), 40000);
    CHECK(joint.bond == 0);
    CHECK(std::abs(joint.work_n / energy_1 + joint.work_s / energy_2 - 1) < 1e-6);
    CHECK(joint.last.opens == (angle < 90));
  }
}

TEST_CASE("friction in tension takes from the energy of shear, not from pure modes") {
  const Real phi = std::tan(40 * std::numbers::pi / 180);
  for (const auto& [angle, sum] :
       {std::pair{0.0, 1.0}, {20.0, 0.92248}, {45.0, 0.83403}, {90.0, 1.0}}) {
    Joint joint{law_of<Real>({.phi = phi, .phi_left = phi})};
    const Real a = angle * std::numbers::pi / 180;
    joint.walk_to(angle == 90 ? 0 : 4e-4 * std::cos(a), 4e-4 * std::sin(a), 40000);
    CHECK(std::abs(joint.work_n / energy_1 + joint.work_s / energy_2 - sum) < 2e-5);
  }
}

TEST_CASE("what is lost is fracture and friction, whatever the way there and back") {
  Random random(1);
  const Rock rock{.phi = 0.7, .phi_left = 0.5, .over = 1e-4, .cohesion_left = 1e6};
  for (int round = 0; round < 50; ++round) {
    Joint joint{law_of<Real>(rock)};
    for (int leg = 0; leg < 4; ++leg) {
      Joint before = joint;
      joint.walk_to(random.between(-2e-6, 3e-5), random.between(-5e-5, 5e-5), 2000);
      if (joint.bond == 0) {
        joint = before;
        break;
      }
      CHECK(joint.state[0] >= before.state[0]);
      CHECK(joint.fracture >= before.fracture - 1e-9);
    }
    const Real lost = joint.work_n + joint.work_s - joint.stored();
    CHECK(std::abs(lost - joint.fracture - joint.friction) < 2e-3 * (energy_2 + std::abs(lost)));
  }
}

TEST_CASE("an open joint unloads and reloads along its secant, without loss") {
  Joint joint{law_of<Real>({})};
  joint.walk_to(3e-5, 0, 1000);
  const Real damage = joint.state[0], pull = -joint.last.normal, fracture = joint.fracture;
  CHECK(damage > 0.3);
  joint.walk_to(1.5e-5, 0, 10);
  CHECK(relative_error(-joint.last.normal, pull / 2) < 1e-12);
  joint.walk_to(3e-5, 0, 10);
  CHECK(relative_error(-joint.last.normal, pull) < 1e-12);
  CHECK(std::abs(joint.state[0] - damage) < 1e-12);
  CHECK(std::abs(joint.fracture - fracture) < 1e-9);
  joint.walk_to(-1e-6, 0, 10);
  CHECK(relative_error(joint.last.normal, kn * 1e-6) < 1e-12);
}

TEST_CASE("under pressure it falls to residual cohesion and friction") {
  const Rock rock{.phi = std::tan(40 * std::numbers::pi / 180),
                  .phi_left = std::tan(30 * std::numbers::pi / 180),
                  .over = 2e-3,
                  .cohesion_left = 1e6};
  Joint joint{law_of<Real>(rock)};
  const Real pressed = 2e6;
  joint.lead_to(-pressed / kn, 0);
  Real most = 0;
  for (Index k = 1; k <= 50000; ++k) {
    joint.lead_to(-pressed / kn, 5e-3 * k / 50000);
    most = std::max(most, -joint.last.shear1);
  }
  CHECK(relative_error(most, cohesion + pressed * rock.phi) < 1e-3);
  CHECK(relative_error(-joint.last.shear1, 2.154700538379e6) < 1e-12);
  const Real slip = joint.state[2];
  const Real spent = energy_2 + rock.cohesion_left * slip +
                     pressed * (rock.phi_left * slip + (rock.phi - rock.phi_left) * rock.over / 2);
  CHECK(relative_error(joint.work_s - joint.last.stored_s, spent) < 1e-6);
  CHECK(relative_error(joint.fracture, energy_2) < 1e-9);
}

TEST_CASE("a contact has friction that falls with the slip, and no cohesion") {
  const Rock rock{.phi = 0.7, .phi_left = 0.5, .over = 1e-3, .cohesion_left = 1e6};
  const Softening<Real> law = law_of<Real>(rock);
  Real state[3] = {1, 0, 5e-4};
  JointInput<Real> in{.opening = -1e6 / kn,
                      .shear1 = 1e-6,
                      .shear2 = 0,
                      .stiffness = JointStiffness<Real>::of(kn, ks),
                      .damping = 0,
                      .bond = 0,
                      .risen = 0,
                      .has_area = 0};
  CHECK(relative_error(-law.respond(in, state).shear1, 1e6 * 0.6) < 1e-3);
  CHECK(state[2] > 5e-4);
  CHECK(Softening<Real>::state[0].loose == 1);
}

TEST_CASE("bears gives the bits of an untouched bond, and does not answer for others") {
  Random random(2);
  const Softening<Real> law = law_of<Real>({.phi = 0.7, .phi_left = 0.5, .over = 1e-3});
  Index held = 0;
  for (int k = 0; k < 1000; ++k) {
    Real state[3] = {0, 0, 0};
    const JointInput<Real> in{.opening = random.between(-2e-6, 1.5e-6),
                              .shear1 = random.between(-2e-6, 2e-6),
                              .shear2 = random.between(-2e-6, 2e-6),
                              .stiffness = JointStiffness<Real>::of(kn, ks),
                              .damping = 0,
                              .bond = 1,
                              .risen = 0,
                              .has_area = 1};
    const Borne<Real> b = law.bears(in, state);
    const JointAnswer<Real> a = law.respond(in, state);
    CHECK(b.holds == (state[0] == 0));
    const Real damaged[3] = {0.1, 1e-6, 0};
    CHECK(!law.bears(in, damaged).holds);
    if (!b.holds) continue;
    ++held;
    CHECK(same_bits(b.normal, a.normal));
    CHECK(same_bits(b.shear1, a.shear1));
    CHECK(relative_error(b.stored, a.stored_n + a.stored_s) < 1e-15);
  }
  CHECK(held > 200);
}

TEST_CASE("what a joint cannot soften from is refused") {
  const auto why = [](Real c, Real t, Real phi_left, Real over, Real c_left, Real g1, Real g2) {
    const Real p[] = {0.7, c, t, 0, 0, phi_left, over, c_left, g1, g2};
    const char* text = Softening<Real>::contradiction(p);
    return std::string(text ? text : "");
  };
  CHECK(why(6e6, 3e6, 0.5, 1e-3, 1e6, 100, 300).empty());
  CHECK(why(6e6, 0, 0.5, 1e-3, 0, 100, 300).starts_with("softening needs cohesion"));
  CHECK(why(6e6, 3e6, 0.5, 1e-3, 6e6, 100, 300).starts_with("residual_cohesion must be below"));
  CHECK(why(6e6, 3e6, 0.5, 1e-3, 0, 0, 300).starts_with("fracture_energy_1"));
  CHECK(why(6e6, 9e6, 0.5, 1e-3, 0, 100, 300).starts_with("tensile_strength must not"));
  CHECK(why(6e6, 3e6, 0.5, 0, 0, 100, 300).starts_with("residual_friction_angle below"));
  const Real p[] = {0.7, 6e6, 3e6, 0, 0, 0.7, 0, 0, 100, 300};
  CHECK(relative_error(Softening<Real>::steepest_fall(p)[0], 3e6 * 3e6 / 200) < 1e-15);
  CHECK(relative_error(Softening<Real>::steepest_fall(p)[1], 6e6 * 6e6 / 600) < 1e-15);
}

TEST_CASE("lanes of the softening law are those of its numbers") {
  Random random(3);
  const Rock rock{.phi = 0.7, .phi_left = 0.5, .over = 1e-4, .cohesion_left = 1e6};
  check_lanes<10, 9>(
      [&](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const JointInput<T> joint{.opening = in[0],
                                  .shear1 = in[1],
                                  .shear2 = in[2],
                                  .stiffness = JointStiffness<T>::of(T(kn), T(ks)),
                                  .damping = T(0.0),
                                  .bond = in[3],
                                  .risen = T(0.0),
                                  .has_area = in[5]};
        T state[3] = {in[6], in[7], in[8]};
        const JointAnswer<T> a = law_of<T>(rock).respond(joint, state);
        out[0] = a.normal, out[1] = a.shear1, out[2] = a.shear2, out[3] = a.bond;
        out[4] = a.fracture, out[5] = a.friction;
        for (int k = 0; k < 3; ++k) out[6 + k] = state[k];
      },
      [&](Real* in) {
        for (int k = 0; k < 3; ++k) in[k] = random.between(-2e-5, 2e-5);
        for (int k : {3, 4, 5}) in[k] = random.below(2);
        in[6] = in[3] > 0 ? random.below(2) * random.between(0, 0.9) : 1;
        in[7] = in[6] * random.between(0, 2e-5), in[8] = in[6] * random.between(0, 2e-5);
        in[9] = 0;
      });
}

}  // namespace cdem::test
