// Energy of the nodes at the time of the forces.
#include "core/nodes/node_energy.hpp"
#include "tests/core/nodes/points.hpp"

namespace cdem::test {

namespace {

SampleNodes sample_kernel(const Points& points, std::vector<Real>& sample, const Real* damping) {
  return {.nodes = {points.motion.data()},
          .mass = points.mass_columns(),
          .loads = points.loads(),
          .supports = points.supports(),
          .reaction = points.reaction.data(),
          .damping_force = damping,
          .dt_before = points.dt_before,
          .dt = points.dt,
          .sample = sample.data()};
}

}  // namespace

TEST_CASE("kinetic energy is half the momentum before times the velocity after") {
  Points points(1);
  points.dt = points.dt_before = 0.1;
  points.mass = {4};
  points.gravity = {0, 0, -10};
  points.move(0, {1, 2, 3});
  std::vector<Real> sample(4);
  NodeMomentum{{points.motion.data()}, points.mass_columns(), sample.data()}(One{0});
  CHECK(distance(vector_at(sample.data()), Vec{4, 8, 12}) == 0);
  CHECK(sample[3] == 4 * (1 + 4 + 9));
  points.move(0, {2, 2, 2});
  sample_kernel(points, sample, nullptr)(One{0});
  CHECK(sample[0] == 0.5 * (4 * 2 + 8 * 2 + 12 * 2));
  CHECK(sample[1] == doctest::Approx(0.5 * 0.1 * 4 * -10 * 2));
  CHECK(sample[2] == 0);
}

TEST_CASE("an oscillator keeps its energy and the step change whatever the steps") {
  constexpr Real stiffness = 1e4, mass = 2;
  const Real longest = 2 / std::sqrt(stiffness / mass);
  for (const bool exact_mass : {false, true}) {
    Random random(3);
    Points points(4);
    points.mass.assign(4, mass);
    if (exact_mass) points.share_matrix(0);
    points.corner = {0, 1, 2, 3};
    points.corner_first = {0, 1, 2, 3, 4};
    points.contact_first = {0, 0, 0, 0, 0};
    points.corner_force.assign(16, 0.0);
    for (Index i = 0; i < 4; ++i)
      points.place(i, random.vector(0.01)), points.move(i, random.vector(1));
    std::vector<Real> sample(16);
    points.dt = 0.1 * longest;
    Real first = 0, largest_change = 0;
    for (int n = 0; n < 500; ++n) {
      points.dt_before = points.dt;
      points.dt = random.between(0.05, exact_mass ? 0.3 : 0.6) * longest;
      Real energy = 0;
      for (Index i = 0; i < 4; ++i) {
        const Vec x = points.position_of(i);
        put(points.corner_force.data() + 4 * i, Real(-stiffness) * x);
        energy += 0.5 * stiffness * dot(x, x);
      }
      for (Index i = 0; i < 4; ++i)
        NodeMomentum{{points.motion.data()}, points.mass_columns(), sample.data()}(One{i});
      points.advance();
      Real change = 0;
      for (Index i = 0; i < 4; ++i) sample_kernel(points, sample, nullptr)(One{i});
      for (Index i = 0; i < 4; ++i) {
        energy += sample[4 * i];
        change += points.step_change[i] - sample[4 * i + 3];
      }
      if (n == 0) first = energy + change;
      largest_change = std::max(largest_change, std::abs(change));
      CHECK(relative_error(energy + change, first) < 1e-11);
    }
    CHECK(largest_change > 0.05 * first);
  }
}

TEST_CASE("work of supports and damping in the half step that follows is sampled") {
  Points points(1);
  points.dt = points.dt_before = 0.1;
  points.support = {0};
  points.component = {1, 1, 1};
  points.reaction = {3, 0, 0, 0};
  points.damping_force = {0, 5, 0, 0};
  points.move(0, {2, -1, 0});
  std::vector<Real> sample(4);
  sample_kernel(points, sample, points.damping_force.data())(One{0});
  CHECK(sample[1] == doctest::Approx(0.5 * 0.1 * 3 * 2));
  CHECK(sample[2] == doctest::Approx(0.5 * 0.1 * 5));
}

}  // namespace cdem::test
