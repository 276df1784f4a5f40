// Dashpots between nodes and the ground.
#include "core/nodes/dashpots.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// One node with dashpots, along and across a direction.
struct Dashed {
  const Index row[1] = {0};
  Real matrix[8] = {}, force[4] = {}, radiated = 0;
  Index support[1] = {-1};
  Flag component[3] = {};
  Dashpots dashpots{row, matrix, force, &radiated};
  SupportColumns supports{support, component, nullptr, nullptr, nullptr};

  Dashed(Random& random, Real size) {
    const Vec n = random.direction();
    const Real across = random.between(0, size), more = random.between(0, size);
    const Real x = n.x, y = n.y, z = n.z;
    const Real c[6] = {across + more * x * x, across + more * y * y, across + more * z * z,
                       more * x * y,          more * y * z,          more * z * x};
    std::copy(c, c + 6, matrix);
  }
  Vec times(const Vec& v) const {
    const Real* c = matrix;
    return {c[0] * v.x + c[3] * v.y + c[5] * v.z, c[3] * v.x + c[1] * v.y + c[4] * v.z,
            c[5] * v.x + c[4] * v.y + c[2] * v.z};
  }
};
Row row_of(const Vec& v) { return Row::of(v.x, v.y, v.z); }

}  // namespace

TEST_CASE("a dashpot acts with the mean of the velocities before and after the step") {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    Dashed one(random, 100);
    const Vec f = random.vector(5), v = random.vector(5);
    const Real mass = random.between(0.1, 3);  // over the kick
    const Vec change = one.dashpots.change(0, one.supports, row_of(f), row_of(v), mass).vector();
    const Vec force = one.dashpots.force_on(0).vector();
    CHECK(distance(force, -one.times(v + 0.5 * change)) < 1e-12 * (1 + norm(force)));
    CHECK(distance(mass * change, f + force) < 1e-11 * (1 + norm(force)));
  }
}

TEST_CASE("without other forces a node slows down and never turns back, however strong they are") {
  Random random(4);
  for (const Real size : {1e-3, 1.0, 1e6}) {
    Dashed one(random, size);
    Vec v = random.vector(1);
    for (int step = 0; step < 100; ++step) {
      const Vec change = one.dashpots.change(0, one.supports, Row::zero(), row_of(v), 1.0).vector();
      CHECK(norm(v + change) <= norm(v) * (1 + 1e-14));
      CHECK(dot(one.dashpots.force_on(0).vector(), v + 0.5 * change) <= 0);
      v = v + change;
    }
  }
}

TEST_CASE("a component that a support gives has no dashpots, and the others as if alone") {
  Random random(5);
  Dashed one(random, 10), alone(random, 10);
  std::copy(one.matrix, one.matrix + 6, alone.matrix);
  for (const int coupled : {0, 3, 5}) alone.matrix[coupled] = 0;
  one.support[0] = 0, one.component[0] = 1;
  const Vec f{0, 2, 3}, v{7, 1, -1};
  const Row with = one.dashpots.change(0, one.supports, row_of(f), row_of(v), 2);
  const Row without = alone.dashpots.change(0, alone.supports, row_of(f), row_of(v), 2);
  CHECK(with.n[0] == 0);
  CHECK(one.force[0] == 0);
  CHECK(distance(with.vector(), without.vector()) < 1e-14);
}

TEST_CASE("a sample knows the work of the half step to come") {
  const Index node[1] = {1};
  const Real motion[16] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 0};
  const Real force[4] = {-5, 0, -1, 0};
  Real sample[2] = {9, 9};
  SampleDashpots{node, {motion}, force, 0.2, sample}(One{0});
  CHECK(sample[0] == 9);
  CHECK(sample[1] == doctest::Approx(0.5 * 0.2 * 8).epsilon(1e-15));
}

}  // namespace cdem::test
