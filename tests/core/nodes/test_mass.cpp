// Masses of nodes: a number each, or the consistent matrix of a small block.
#include "core/nodes/mass.hpp"
#include "tests/core/nodes/points.hpp"

namespace cdem::test {

TEST_CASE("the momentum of a lumped node is mass times velocity") {
  Points points(2);
  points.mass = {3, 5};
  points.move(1, {1, 2, 3});
  const MassColumns mass = points.mass_columns();
  CHECK(mass.row(1) == -1);
  CHECK(!mass.held(1));
  CHECK(distance(mass.momentum({points.motion.data()}, 1).vector(), Vec{5, 10, 15}) == 0);
}

TEST_CASE("the exact matrix gives a tet its mass, and its inertia about any axis") {
  Random random(1);
  Points points(4);
  points.share_matrix(0);
  points.mass.assign(4, 6.0);  // 24 kg
  const Vec spin = random.vector(1), drift = random.vector(1);
  Vec center{0, 0, 0};
  for (Index i = 0; i < 4; ++i) {
    points.place(i, random.vector(1));
    center = center + Real(0.25) * points.position_of(i);
  }
  for (Index i = 0; i < 4; ++i) points.move(i, drift + cross(spin, points.position_of(i) - center));
  Vec linear{0, 0, 0}, angular{0, 0, 0};
  for (Index i = 0; i < 4; ++i) {
    const Vec p = points.mass_columns().momentum({points.motion.data()}, i).vector();
    linear = linear + p;
    angular = angular + cross(points.position_of(i) - center, p);
  }
  CHECK(distance(linear, Real(24) * drift) < 2e-14);
  // second moments of a tet about its centre: sum of those of its corners, over 20
  Mat inertia{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  for (Index i = 0; i < 4; ++i) {
    const Vec arm = points.position_of(i) - center;
    inertia = inertia + Real(24 * dot(arm, arm) / 20) * identity<Real>();
    add_outer(inertia, Real(-24.0 / 20) * arm, arm);
  }
  CHECK(distance(angular, inertia * spin) < 1e-14);
}

TEST_CASE("the inverse of a shared matrix is its inverse") {
  Points points(4);
  points.share_matrix(0);
  for (Index j = 0; j < 4; ++j)
    for (Index k = 0; k < 4; ++k) {
      Real sum = 0;
      for (Index l = 0; l < 4; ++l) sum += points.matrix[4 * j + l] * points.inverse[4 * l + k];
      CHECK(std::abs(sum - (j == k)) < 1e-15);
    }
}

TEST_CASE("a given motion of a node pulls at the others through the matrix") {
  Points points(4);
  points.share_matrix(0);
  points.support = {0, -1, -1, -1};
  points.component = {1, 0, 0};
  points.given = {2, 0, 0};
  points.stride.assign(4, 16);  // as of a block that is held
  points.move(0, {0.5, 7, 0});
  const MassColumns mass = points.mass_columns();
  CHECK(mass.held(1));
  constexpr Real kick = 0.1;
  const Row inertia = mass.given_inertia(points.supports(), {points.motion.data()}, 1, kick);
  CHECK(distance(inertia.vector(), Vec{0.2 * (2 - 0.5) / kick, 0, 0}) < 2e-15);
}

}  // namespace cdem::test
