// Energy of the nodes at the time of the forces.
#include "core/nodes/node_energy.hpp"
#include "tests/core/nodes/points.hpp"

namespace cdem::test {

TEST_CASE("kinetic energy is half the momentum before times the velocity after") {
  Points points(1);
  points.mass = {4};
  points.gravity = {0, 0, -10};
  points.move(0, {1, 2, 3});
  std::vector<Real> sample(4);
  NodeMomentum{{points.motion.data()}, points.mass_columns(), sample.data()}(One{0});
  CHECK(distance(vector_at(sample.data()), Vec{4, 8, 12}) == 0);
  points.move(0, {2, 2, 2});
  SampleNodes{{points.motion.data()}, points.loads(), points.supports(),
              points.reaction.data(), nullptr,        0.1,
              sample.data()}(One{0});
  CHECK(sample[0] == 0.5 * (4 * 2 + 8 * 2 + 12 * 2));
  CHECK(sample[1] == doctest::Approx(0.5 * 0.1 * 4 * -10 * 2));
  CHECK(sample[2] == 0);
}

TEST_CASE("work of supports and damping in the half step that follows is sampled") {
  Points points(1);
  points.support = {0};
  points.component = {1, 1, 1};
  points.reaction = {3, 0, 0, 0};
  points.damping_force = {0, 5, 0, 0};
  points.move(0, {2, -1, 0});
  std::vector<Real> sample(4);
  SampleNodes{{points.motion.data()},
              points.loads(),
              points.supports(),
              points.reaction.data(),
              points.damping_force.data(),
              0.1,
              sample.data()}(One{0});
  CHECK(sample[1] == doctest::Approx(0.5 * 0.1 * 3 * 2));
  CHECK(sample[2] == doctest::Approx(0.5 * 0.1 * 5));
}

}  // namespace cdem::test
