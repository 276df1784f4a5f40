// From corner forces to motion: sum, damping, supports, central differences.
#include <vector>

#include "core/base/parallel.hpp"
#include "core/nodes/central_difference.hpp"
#include "tests/core/nodes/points.hpp"

namespace cdem::test {

TEST_CASE("a node sums its corner rows, those of bonds with their sign, contacts and weight") {
  Points points(2);
  points.corner_first = {0, 3, 4};
  points.corner = {0, 2, ~1, 1};
  points.contact_first = {0, 1, 1};
  points.contact_corner = {0};
  points.corner_force = {1, 2, 3, 0, 10, 20, 30, 0, 100, 200, 300, 0};
  points.contact_force = {0.5, 0.25, 0.125, 7};
  points.mass = {2, 3};
  points.gravity = {0, 0, -10};
  points.sum_kernel()(One{0});
  points.sum_kernel()(One{1});
  CHECK(distance(points.force_of(0),
                 Vec{1 + 100 - 10 + 0.5, 2 + 200 - 20 + 0.25, 3 + 300 - 30 + 0.125 - 20}) == 0);
  CHECK(points.force[3] == 7);  // stiffness of the contacts
  CHECK(distance(points.force_of(1), Vec{10, 20, 0}) == 0);
  CHECK(points.unbalance[0] == std::abs(91.5) + std::abs(182.25) + std::abs(253.125));
}

TEST_CASE("local damping opposes the velocity with a part of the unbalanced force") {
  Points points(1);
  points.corner_force = {10, -20, 30, 0};
  points.corner = {0};
  points.corner_first = {0, 1};
  points.damping.local = 0.8;
  points.move(0, {1, 2, 0});
  points.sum_kernel()(One{0});
  CHECK(distance(points.force_of(0), Vec{10 - 8, -20 - 16, 30}) < 1e-14);
  CHECK(distance(vector_at(points.damping_force.data()), Vec{-8, -16, 0}) < 1e-14);
}

TEST_CASE("mass damping opposes the momentum") {
  Points points(1);
  points.mass = {3};
  points.damping.mass = 0.5;
  points.move(0, {1, -2, 4});
  points.sum_kernel()(One{0});
  CHECK(distance(points.force_of(0), Real(-1.5) * Vec{1, -2, 4}) == 0);
}

TEST_CASE("a support moves its node as given; its force is what was missing") {
  Points points(1);
  points.mass = {2};
  points.support = {0};
  points.component = {1, 0, 1};
  points.given = {3, 0, 0};
  points.corner_force = {5, 6, 7, 0};
  points.corner = {0};
  points.corner_first = {0, 1};
  points.move(0, {1, 1, 1});
  points.sum_kernel()(One{0});
  points.move_kernel()(One{0});
  const Real dt = points.dt;
  CHECK(distance(points.velocity_of(0), Vec{3, 1 + dt * 6 / 2, 0}) < 1e-15);
  CHECK(distance(points.position_of(0), dt * points.velocity_of(0)) < 1e-16);
  CHECK(distance(vector_at(points.reaction.data()), Vec{2 * (3 - 1) / dt - 5, 0, -2 / dt - 7}) <
        1e-11);
}

TEST_CASE("an oscillator keeps its energy, kinetic energy being half v before times v after") {
  constexpr Real stiffness = 1e4, mass = 2;
  const Real frequency = std::sqrt(stiffness / mass);
  for (const Real part : {0.1, 0.5, 0.95}) {  // of the stable step
    Points points(1);
    points.mass = {mass};
    points.dt = points.dt_before = part * 2 / frequency;
    points.corner = {0};
    points.corner_first = {0, 1};
    points.corner_force = {0, 0, 0, 0};
    points.place(0, {0.01, 0, 0});
    points.move(0, {0.3, 0, 0});
    Real first = 0;
    for (int n = 0; n < 1000; ++n) {
      const Vec x = points.position_of(0), before = points.velocity_of(0);
      put(points.corner_force.data(), Real(-stiffness) * x);
      points.advance();
      const Real energy =
          0.5 * mass * dot(before, points.velocity_of(0)) + 0.5 * stiffness * dot(x, x);
      if (n == 0) first = energy;
      CHECK(relative_error(energy, first) < 2e-13);
    }
  }
}

TEST_CASE("a step beyond the stable one blows up") {
  Points points(1);
  points.mass = {1};
  points.dt = points.dt_before = 2.01;
  points.corner = {0};
  points.corner_first = {0, 1};
  points.corner_force = {0, 0, 0, 0};
  points.place(0, {1, 0, 0});
  for (int n = 0; n < 300; ++n) {
    put(points.corner_force.data(), -points.position_of(0));
    points.advance();
  }
  CHECK(norm(points.position_of(0)) > 1e6);
}

TEST_CASE("gravity accelerates what is free, and its work is weight times fall") {
  Points points(1);
  points.mass = {5};
  points.gravity = {0, 0, -9.81};
  points.dt_before = 0;  // starts from rest with half a kick
  points.corner_first = {0, 0};
  for (int n = 0; n < 100; ++n) {
    points.advance();
    points.dt_before = points.dt;
  }
  const Real time = 100 * points.dt;
  CHECK(relative_error(-points.position_of(0).z, 0.5 * 9.81 * time * time) < 5e-15);
  // the last force has worked until half a step before now
  const Real fall = points.position_of(0).z - 0.5 * points.dt * points.velocity_of(0).z;
  CHECK(relative_error(points.work_external[0], -5 * 9.81 * fall) < 5e-15);
}

TEST_CASE("damping takes out the work that it says") {
  Points points(1);
  points.mass = {2};
  points.damping.mass = 3;
  points.move(0, {1, 0, 0});
  points.corner_first = {0, 0};
  for (int n = 0; n < 200; ++n) points.advance();
  const Real lost = 0.5 * 2 * (1 - dot(points.velocity_of(0), points.velocity_of(0)));
  CHECK(points.velocity_of(0).x < 0.01);
  CHECK(relative_error(points.work_damping[0], lost) < 3e-15);
}

TEST_CASE("sum and motion in one pass give the bits of both in turn") {
  const auto fill = [](Points& points) {
    Random random(1);
    for (Index i = 0; i < points.count; ++i) {
      points.place(i, random.vector(1));
      points.move(i, random.vector(1));
      points.corner.push_back(i % 2 ? i : ~i);
      points.corner_first[i + 1] = i + 1;
      for (Index axis = 0; axis < 4; ++axis) points.corner_force.push_back(random.between(-1, 1));
    }
    points.damping = {0.3, 0.1};
    points.gravity = {1, 2, 3};
  };
  Points in_turn(10), at_once(10);
  fill(in_turn);
  fill(at_once);
  for (Index i = 0; i < 10; ++i) in_turn.sum_kernel()(One{i});
  for (Index i = 0; i < 10; ++i) in_turn.move_kernel()(One{i});
  at_once.advance();
  CHECK(at_once.motion == in_turn.motion);
  CHECK(at_once.work_damping == in_turn.work_damping);
  CHECK(at_once.work_external == in_turn.work_external);
}

TEST_CASE("nodes that are moved with their elements are left alone") {
  Points points(2);
  points.corner_first = {0, 0, 0};
  points.move(0, {1, 0, 0});
  points.move(1, {1, 0, 0});
  points.fused = {0, 1};
  points.advance();
  CHECK(points.position_of(0).x > 0);
  CHECK(points.position_of(1).x == 0);
}

TEST_CASE("nodes of a small block share the exact mass matrix") {
  // a free tet: a force on one node pushes the others back, momentum is that of the force
  Points points(4);
  points.share_matrix(0);
  points.corner_force = {8, 0, 0, 0};
  points.corner = {0};
  points.corner_first = {0, 1, 1, 1, 1};
  points.advance();
  const Real kick = points.dt / points.mass[0];
  CHECK(relative_error(points.velocity_of(0).x, 4 * 8 * kick) < 1e-15);
  for (Index i = 1; i < 4; ++i) CHECK(relative_error(points.velocity_of(i).x, -8 * kick) < 1e-15);
  Vec momentum{0, 0, 0};
  for (Index i = 0; i < 4; ++i)
    momentum = momentum + points.mass_columns().momentum({points.motion.data()}, i).vector();
  CHECK(relative_error(momentum.x, 8 * points.dt) < 1e-15);
}

}  // namespace cdem::test
