// Rock with a weak plane: Jaeger's strength, what the plane spends and remembers, lanes.
#include <string>

#include "core/materials/laws.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

Real tangent(Real degrees) { return std::tan(degrees * M_PI / 180); }

/// The law from what a case says, angles in degrees.
UbiquitousJoint<Real> law_of_case(const std::array<Real, 10>& said) {
  std::array<Real, 10> row = said;
  for (const Index k : {1, 2, 7, 8}) row[k] = tangent(said[k]);
  for (const Index k : {4, 5}) row[k] = tangent(said[k] / 2);
  const auto numbers = UbiquitousJoint<Real>::prepare(row.data());
  return UbiquitousJoint<Real>::read([&](Index k) { return numbers[k]; });
}

Sym3<Real> random_stress(Random& random) {
  const Real mean = random.between(-5, 5);
  return symmetric(random.matrix(4)) + Sym3<Real>{mean, mean, mean, 0, 0, 0};
}

}  // namespace

TEST_CASE("the normal follows dip and dip direction") {
  for (const Real dip : {0.0, 30.0, 90.0})
    for (const Real direction : {0.0, 90.0, 135.0, 180.0, 300.0, 360.0}) {
      const auto law = law_of_case({1, 30, 0, unlimited, dip, direction, 1, 30, 0, unlimited});
      const Real a = dip * M_PI / 180, b = direction * M_PI / 180;
      const Vec known{std::sin(a) * std::sin(b), std::sin(a) * std::cos(b), std::cos(a)};
      CHECK(distance(law.normal, known) < 1e-15);
    }
}

TEST_CASE("a column between rollers bears what Jaeger says") {
  // c 2, phi 40, cj 1, phi_j 30; b is the angle between the normal and the axis, here the dip
  const Real known[][2] = {{0, 8.5780},  {30, 8.5780}, {40, 6.5104}, {50, 3.9392},
                           {60, 3.4641}, {70, 3.9392}, {80, 6.5104}, {90, 8.5780}};
  const ElasticConstants<Real> elastic{1000, 1000};
  for (const auto& [dip, strength] : known) {
    const auto law = law_of_case({2, 40, 0, unlimited, dip, 90, 1, 30, 0, unlimited});
    // just inside and just outside, uniaxial: the first stays elastic, the second flows
    for (const Real part : {0.9999, 1.0001}) {
      Real state[4] = {};
      const auto flow = law.flow(elastic, {0, 0, -part * strength, 0, 0, 0}, state);
      CHECK((contract(flow, flow) > 0) == (part > 1));
    }
  }
}

TEST_CASE("the plane bears no more than its strength, and the flow spends energy") {
  Random random(4);
  const ElasticConstants<Real> elastic{800, 1000};
  Real over_plane = 0, over_rock = 0, made = 0;
  int slid = 0, opened = 0;
  for (int k = 0; k < 20000; ++k) {
    const Real phi = random.between(0, 50), part = random.between(0, 1);
    const auto law = law_of_case({random.between(1, 3), 40, 10, unlimited, random.between(0, 90),
                                  random.between(0, 360), random.between(0.1, 1), phi, part * phi,
                                  random.below(2) ? unlimited : random.between(0, 0.5)});
    const Sym3<Real> trial = random_stress(random);
    Real state[4] = {};
    const auto flow = law.flow(elastic, trial, state);
    const Sym3<Real> stress = trial - elastic.stress(flow);
    const Vec traction = full(stress) * law.normal;
    const Real across = dot(law.normal, traction);
    const Real along = norm(traction - across * law.normal);
    over_plane = std::max(over_plane, across - law.tensile_strength);
    over_plane = std::max(over_plane, along - law.cohesion + across * law.tan_friction);
    // the rock comes first in each turn: what the plane gives back may lie outside it
    Real none[2] = {};
    const auto again = law.rock.flow(elastic, stress, none);
    over_rock = std::max(over_rock, norm(full(elastic.stress(again)) * Vec{1, 1, 1}));
    if (state[0] + state[1] == 0) made = std::max(made, -contract(stress, flow));
    for (const Real number : state) CHECK(number >= 0);
    slid += state[2] > 0, opened += state[3] > 0;
  }
  CHECK(over_plane < 1e-9);
  CHECK(over_rock < 1.5);
  CHECK(made < 1e-9);
  CHECK(slid > 5000);
  CHECK(opened > 1000);
}

TEST_CASE("slip and opening of the plane are remembered apart, in measures that are known") {
  const ElasticConstants<Real> elastic{100, 100};
  const auto level = law_of_case({50, 0, 0, unlimited, 0, 0, 1, 0, 0, 2});
  Real slid[4] = {}, opened[4] = {};
  level.flow(elastic, {0, 0, 0, 0, 1.5, 0}, slid);  // half of c too much: angle 0.5 / mu
  CHECK(relative_error(slid[2], 0.5 / 100) < 1e-14);
  CHECK(slid[0] + slid[1] + slid[3] == 0);
  level.flow(elastic, {0, 0, 3, 0, 0, 0}, opened);  // 1 over T, lambda + 2 mu = 300
  CHECK(relative_error(opened[3], 1.0 / 300) < 1e-14);
  CHECK(opened[0] + opened[1] + opened[2] == 0);
}

TEST_CASE("a plane that opens while it slides bears what both limits leave") {
  const ElasticConstants<Real> elastic{100, 100};
  const auto level = law_of_case({50, 0, 0, unlimited, 0, 0, 1, 30, 5, 0.5});
  Real state[4] = {};
  const Sym3<Real> trial{0, 0, 3, 0, 4, 0};
  const auto stress = trial - elastic.stress(level.flow(elastic, trial, state));
  CHECK(relative_error(stress.zz, 0.5) < 1e-13);
  CHECK(relative_error(stress.yz, 1 - 0.5 * tangent(30)) < 1e-13);
}

TEST_CASE("a plane of too much dilation is refused") {
  Real row[] = {1, 0.5, 0, unlimited, 0, 0, 1, 0.5, 0.6, unlimited};
  CHECK(std::string(UbiquitousJoint<Real>::contradiction(row)).starts_with("joint_dilation_angle"));
  row[8] = 0.5;
  CHECK(UbiquitousJoint<Real>::contradiction(row) == nullptr);
  row[0] = row[1] = 0;
  CHECK(std::string(UbiquitousJoint<Real>::contradiction(row)).starts_with("cohesion and"));
}

TEST_CASE("flow of a lane with weak planes is that of its numbers") {
  Random random(5);
  check_lanes<17, 10>(
      [](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const auto law = UbiquitousJoint<T>::read([&](Index k) { return in[k]; });
        for (Index k = 6; k < 10; ++k) out[k] = T(0.25);
        const auto e = law.flow({T(800.0), T(1000.0)},
                                {in[11], in[12], in[13], in[14], in[15], in[16]}, out + 6);
        out[0] = e.xx, out[1] = e.yy, out[2] = e.zz, out[3] = e.xy, out[4] = e.yz, out[5] = e.zx;
      },
      [&](Real* in) {
        const Real row[] = {2,
                            tangent(40),
                            tangent(10),
                            unlimited,
                            tangent(random.between(0, 45)),
                            tangent(random.between(0, 80)),
                            random.between(0.1, 1),
                            tangent(30),
                            0.1,
                            random.below(2) ? unlimited : 0.2};
        const auto numbers = UbiquitousJoint<Real>::prepare(row);
        std::copy(numbers.begin(), numbers.end(), in);
        const Sym3<Real> s = Real(random.below(2) ? 1 : 0.1) * random_stress(random);
        in[11] = s.xx, in[12] = s.yy, in[13] = s.zz, in[14] = s.xy, in[15] = s.yz, in[16] = s.zx;
      });
}

}  // namespace cdem::test
