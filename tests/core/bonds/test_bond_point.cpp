// One bond point: elastic until it breaks, frictional until its pair is released.
#include "core/bonds/bond_point.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

namespace {

constexpr Real area = 0.25, kn = 2e9, ks = 1e9, dt = 1e-5;
constexpr Real cohesion = 3e5, tension = 1e5, tan_phi = 0.5;
const Joints rock{
    {{"cohesion", cohesion}, {"tensile_strength", tension}, {"friction_angle", tan_phi}}};
const InterfaceTable table = rock.table();
const auto laws = joint_laws<InterfaceLaws>(table, Index(0));
const BondSpring<Real> spring{.area = area, .stiffness = JointStiffness<Real>::of(kn, ks)};

/// A bond point that is led along a path of jumps, and its ledger.
struct Point {
  Frame<Real> frame{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
  bool searched = false;
  InterfaceTable interfaces = table;
  BondHistory<Real> history{1, 0, 0};
  Vec jump{0, 0, 0};
  BondForce<Real> last{};
  Real work = 0, fracture = 0, friction = 0;
  Index broken = 0;

  void lead_to(const Vec& to) {
    Real state[InterfaceLaws::most_state + 1] = {};
    const Vec force = last.on_b;
    const Vec lift = history.rise * frame.n;
    last = bond_force(joint_laws<InterfaceLaws>(interfaces, Index(0)), spring, frame, to - lift,
                      jump - lift, dt, searched, history, state);
    work -= 0.5 * dot(force + last.on_b, to - jump);
    fracture += last.fracture;
    friction += last.friction;
    broken += last.tension + last.shear > 0;
    jump = to;
  }
  /// In many steps.
  void walk_to(const Vec& to, int steps = 200) {
    const Vec from = jump;
    for (int k = 1; k <= steps; ++k) lead_to(from + Real(k) / steps * (to - from));
  }
};

}  // namespace

TEST_CASE("an intact point is a spring: force against the jump, energy of its area") {
  Point point;
  const Vec jump{1e-5, -2e-5, -3e-5};
  point.lead_to(jump);
  CHECK(distance(point.last.on_b, area * Vec{-ks * jump.x, -ks * jump.y, -kn * jump.z}) < 1e-11);
  CHECK(relative_error(point.last.stored, 0.5 * area * (ks * 5e-10 + kn * 9e-10)) < 1e-14);
  CHECK(point.history.bond == 1);
  CHECK(point.history.slip1 == 0);
  CHECK(point.last.tension + point.last.shear + point.last.fracture + point.last.friction == 0);
}

TEST_CASE("it breaks in tension at T, counts it so and carries nothing then") {
  Point point;
  point.lead_to({0, 0, tension / kn});
  CHECK(relative_error(-point.last.on_b.z, area * tension) < 1e-14);
  point.lead_to({0, 0, 1.01 * tension / kn});
  CHECK(point.last.tension == 1);
  CHECK(point.last.shear == 0);
  CHECK(norm(point.last.on_b) == 0);
  CHECK(point.history.bond == 0);
  // what it held and was given in the step is lost to fracture
  CHECK(relative_error(point.fracture, point.work) < 1e-12);
}

TEST_CASE("it breaks in shear at c and goes on with friction") {
  Point point;
  const Real pressed = 4e5;
  point.lead_to({0, 0, -pressed / kn});
  point.walk_to({1.1 * (cohesion + tan_phi * pressed) / ks, 0, -pressed / kn});
  CHECK(point.broken == 1);
  CHECK(point.history.bond == 0);
  CHECK(relative_error(-point.last.on_b.x, area * tan_phi * pressed) < 1e-12);
  CHECK(relative_error(point.last.on_b.z, area * pressed) < 1e-12);
  CHECK(point.history.slip1 > 0);
  // turned back, it is elastic until the friction acts the other way
  const Real x = point.jump.x;
  point.walk_to({x - 2.01 * tan_phi * pressed / ks, 0, -pressed / kn});
  CHECK(relative_error(point.last.on_b.x, area * tan_phi * pressed) < 1e-12);
}

TEST_CASE("a broken point that slips rises by tan(psi) of that, to its height; friction pays") {
  const Real tan_psi = 0.2, most = 1e-3, pressed = 3e-4;
  const Joints rough{
      {{"friction_angle", 0.6}, {"dilation_angle", tan_psi}, {"dilation_slip", most}}};
  Point point;
  point.interfaces = rough.table();
  point.history.bond = 0;
  point.walk_to({0, 0, -pressed});
  for (int k = 1; k <= 100; ++k) {
    point.lead_to({k * 3e-5, 0, -pressed});
    const Real rise = point.history.rise;
    CHECK(relative_error(point.last.on_b.z, area * kn * (pressed + rise)) < 1e-13);
    if (rise < tan_psi * most)
      CHECK(std::abs(rise - tan_psi * point.history.slip1) < 1e-16);
    else
      CHECK(relative_error(rise, tan_psi * most) < 1e-14);
  }
  CHECK(point.history.slip1 > most);
  CHECK(relative_error(point.work, point.last.stored + point.friction) < 1e-13);
  point.searched = true;
  point.history.rise = 0;
  point.lead_to({0, 0, -pressed});
  CHECK(point.history.rise == 0);  // it carries nothing
}

TEST_CASE("a cycle of slip loses friction times way") {
  Point point;
  const Real pressed = 4e5, reach = 1e-2;
  point.history.bond = 0;
  point.lead_to({0, 0, -pressed / kn});
  point.walk_to({reach, 0, -pressed / kn});
  const Real before = point.friction;
  point.walk_to({-reach, 0, -pressed / kn});
  point.walk_to({reach, 0, -pressed / kn});
  const Real limit = area * tan_phi * pressed, elastic = tan_phi * pressed / ks;
  CHECK(relative_error(point.friction - before, 2 * limit * (2 * reach - 2 * elastic)) < 1e-14);
}

TEST_CASE("what a pressed point loses is work less what is stored, whatever the path") {
  Random random(1);
  Index shear_breaks = 0, slid = 0;
  for (int round = 0; round < 100; ++round) {
    Point point;
    const Mat r = random.rotation();
    point.frame = {r.r0, r.r1, r.r2};
    const Real normal = random.between(-4e-4, 0);
    point.walk_to(normal * r.r0, 20);
    for (int k = 0; k < 5; ++k) {
      const Vec to =
          normal * r.r0 + random.between(-6e-4, 6e-4) * r.r1 + random.between(-6e-4, 6e-4) * r.r2;
      const Vec from = point.jump;
      for (int n = 1; n <= 20; ++n) {
        point.lead_to(from + Real(n) / 20 * (to - from));
        CHECK(point.last.friction > -1e-12);
        CHECK(point.last.fracture > -1e-12);
      }
    }
    const Real lost = point.fracture + point.friction;
    CHECK(std::abs(point.work - point.last.stored - lost) < 5e-15 * point.work);
    shear_breaks += point.broken;
    slid += point.friction > 0;
  }
  CHECK(shear_breaks > 50);
  CHECK(slid > 50);
}

TEST_CASE("what a point loses that is pulled apart is the work done on it") {
  Random random(4);
  for (int round = 0; round < 20; ++round) {
    Point point;
    point.walk_to({random.between(-1e-4, 1e-4), random.between(-1e-4, 1e-4), 1e-4});
    CHECK(point.broken == 1);
    CHECK(point.last.stored == 0);
    CHECK(relative_error(point.fracture, point.work) < 2e-15);
  }
}

TEST_CASE("a point that shears off while it is pulled lets go, and all it held is lost") {
  Point point;
  const Real pull = 0.5 * tension;
  point.walk_to({0, 0, pull / kn});
  point.walk_to({1.5 * cohesion / ks, 0, pull / kn});
  CHECK(point.broken == 1);
  CHECK(point.history.bond == 0);
  CHECK(norm(point.last.on_b) == 0);
  CHECK(relative_error(point.fracture + point.friction, point.work) < 5e-15);
}

TEST_CASE("a broken point in an open hinge carries nothing, an intact one goes on") {
  for (const bool searched : {false, true}) {
    Point point;
    point.searched = searched;
    point.lead_to({0, 0, -1e-5});
    CHECK(norm(point.last.on_b) > 0);
    point.history.bond = 0;
    point.lead_to({0, 0, -1e-5});
    CHECK((norm(point.last.on_b) == 0) == searched);
    CHECK((point.last.stored == 0) == searched);
  }
}

TEST_CASE("bears gives the bits of bond_force for what is intact and stays so") {
  Random random(2);
  Index held = 0;
  for (int k = 0; k < 500; ++k) {
    Point point;
    const Mat r = random.rotation();
    point.frame = {r.r0, r.r1, r.r2};
    const Vec jump = random.vector(2e-4);
    Vec on_b;
    const bool holds = bears(laws, spring, point.frame, jump, static_cast<Real*>(nullptr), on_b);
    const Real stored = intact_energy(laws, spring, point.frame, jump, static_cast<Real*>(nullptr));
    point.lead_to(jump);
    CHECK(holds == (point.history.bond == 1));
    if (!holds) continue;
    ++held;
    CHECK(same_bits(on_b.x, point.last.on_b.x));
    CHECK(same_bits(on_b.z, point.last.on_b.z));
    CHECK(same_bits(stored, point.last.stored));
  }
  CHECK(held > 100);
}

TEST_CASE("points of a lane are those of its numbers") {
  Random random(3);
  check_lanes<19, 12>(
      [&](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const BondSpring<T> own{.area = T(area), .stiffness = JointStiffness<T>::of(T(kn), T(ks))};
        const Frame<T> frame{vector_at(in), vector_at(in + 3), vector_at(in + 6)};
        BondHistory<T> h{in[15], in[16], in[17]};
        T state[InterfaceLaws::most_state + 1];
        const auto searched = in[18] > T(0.5);
        BondForce<T> f;
        if constexpr (std::is_same_v<T, Pack>)
          f = bond_force(joint_laws<InterfaceLaws>(table, IndexPack{}), own, frame,
                         vector_at(in + 9), vector_at(in + 12), dt, searched, h, state);
        else
          f = bond_force(laws, own, frame, vector_at(in + 9), vector_at(in + 12), dt, searched, h,
                         state);
        put(out, f.on_b);
        out[3] = f.stored, out[4] = f.fracture, out[5] = f.friction;
        out[6] = f.tension, out[7] = f.shear;
        out[8] = h.bond, out[9] = h.slip1, out[10] = h.slip2, out[11] = T(0.0);
      },
      [&](Real* in) {
        const Mat r = random.rotation();
        put(in, r.r0), put(in + 3, r.r1), put(in + 6, r.r2);
        const Vec jump = random.vector(4e-4);
        put(in + 9, jump), put(in + 12, jump - random.vector(1e-5));
        in[15] = random.below(2);
        in[16] = in[15] > 0 ? 0 : random.between(-1e-4, 1e-4);
        in[17] = in[15] > 0 ? 0 : random.between(-1e-4, 1e-4);
        in[18] = random.below(2);
      });
}

}  // namespace cdem::test
