// The table of interfaces: each lane is answered by its own law and parameters.
#include <set>
#include <string>

#include "core/interfaces/laws.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

namespace {

JointInput<Real> any_joint(Random& random) {
  return {.opening = random.between(-2e-4, 2e-4),
          .shear1 = random.between(-2e-4, 2e-4),
          .shear2 = random.between(-2e-4, 2e-4),
          .stiffness = JointStiffness<Real>::of(2e9, 1e9),
          .damping = random.between(-1e5, 1e5),
          .bond = Real(random.below(2)),
          .risen = 0,
          .has_area = Real(random.below(2))};
}

constexpr Real* none = nullptr;  // no state

const Joints joints{{{"friction_angle", 0.2}},
                    {{"friction_angle", 0.7}, {"cohesion", 1e5}},
                    {{"friction_angle", 0.5}, {"dilation_angle", 0.3}, {"dilation_slip", 1e-3}}};

}  // namespace

TEST_CASE("a joint is answered with the parameters of its interface") {
  Random random(1);
  const InterfaceTable table = joints.table();
  for (int k = 0; k < 100; ++k) {
    const Index interface = random.below(3);
    const JointInput<Real> in = any_joint(random);
    const JointAnswer<Real> a =
        joint_laws<InterfaceLaws>(table, interface).respond(in, static_cast<Real*>(nullptr));
    const JointAnswer<Real> own = joints.law(interface).respond(in, nullptr);
    CHECK(same_bits(a.normal, own.normal));
    CHECK(same_bits(a.shear1, own.shear1));
    CHECK(same_bits(a.rise, own.rise));
    CHECK(a.bond == own.bond);
    CHECK(joint_laws<InterfaceLaws>(table, interface).bears(in, none).holds ==
          joints.law(interface).bears(in, none).holds);
  }
}

TEST_CASE("lanes of different interfaces are answered like each of them") {
  Random random(2);
  const InterfaceTable table = joints.table();
  for (int k = 0; k < 100; ++k) {
    IndexPack interface;
    JointInput<Real> one[lanes];
    for (Index j = 0; j < lanes; ++j) {
      interface.id[j] = random.below(3);
      one[j] = any_joint(random);
    }
    const auto pack = [&](Real JointInput<Real>::* number) {
      return pack_of([&](Index j) { return one[j].*number; });
    };
    using In = JointInput<Real>;
    const JointInput<Pack> in{.opening = pack(&In::opening),
                              .shear1 = pack(&In::shear1),
                              .shear2 = pack(&In::shear2),
                              .stiffness = JointStiffness<Pack>::of(2e9, 1e9),
                              .damping = pack(&In::damping),
                              .bond = pack(&In::bond),
                              .risen = pack(&In::risen),
                              .has_area = pack(&In::has_area)};
    const JointAnswer<Pack> a =
        joint_laws<InterfaceLaws>(table, interface).respond(in, static_cast<Pack*>(nullptr));
    const Borne<Pack> b =
        joint_laws<InterfaceLaws>(table, interface).bears(in, static_cast<Pack*>(nullptr));
    for (Index j = 0; j < lanes; ++j) {
      const JointAnswer<Real> own = joint_laws<InterfaceLaws>(table, interface.id[j])
                                        .respond(one[j], static_cast<Real*>(nullptr));
      CHECK(same_bits(a.normal.n[j], own.normal));
      CHECK(same_bits(a.shear2.n[j], own.shear2));
      CHECK(same_bits(a.rise.n[j], own.rise));
      CHECK(holds(b.holds, j) ==
            joint_laws<InterfaceLaws>(table, interface.id[j]).bears(one[j], none).holds);
    }
  }
}

TEST_CASE("the number of a law selects its lanes") {
  IndexPack interface;
  for (Index j = 0; j < lanes; ++j) interface.id[j] = j % 3;
  const InterfaceTable table = joints.table();
  CHECK(lane_bits(table.has_law<0>(interface)) == (1u << lanes) - 1);
  CHECK(lane_bits(table.has_law<1>(interface)) == 0);
  CHECK(table.law_of(2) == 0);
}

TEST_CASE("every law has a name of its own, and parameters with names and defaults in range") {
  std::set<std::string> laws;
  InterfaceLaws::for_each([&]<template <class> class Law, Index number>() {
    CHECK(number == Index(laws.size()));
    CHECK(laws.insert(Law<Real>::text.name).second);
    std::set<std::string> names;
    for (const Parameter& p : Law<Real>::parameters) {
      CHECK(names.insert(p.name).second);
      CHECK(p.at_least < p.below);
      const bool given = p.otherwise == p.otherwise && p.otherwise != unlimited;
      if (given) CHECK((p.otherwise >= p.at_least && p.otherwise < p.below));
    }
  });
  CHECK(Index(laws.size()) == InterfaceLaws::count);
}

}  // namespace cdem::test
