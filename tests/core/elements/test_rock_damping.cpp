// Damping of rock that remembers: Maxwell branches and Rayleigh dashpots in elements.
#include "core/elements/change_damping.hpp"
#include "core/elements/corotational.hpp"
#include "core/elements/rock_damping.hpp"
#include "core/elements/views.hpp"
#include "tests/core/elements/reference.hpp"

namespace cdem::test {

namespace {

#define ALL_SHAPES Tet4, Pyramid5, Wedge6, Hex8, Hex8OnePoint

constexpr Real modulus_scale = 1e10;  // [Pa]

/// Elements with branches and dashpots.
template <class Shape>
struct Damped : Elements<Shape> {
  using Elements<Shape>::Elements;
  std::vector<Real> branch = std::vector<Real>(RockDamping<Shape>::branch_rows * this->stride);
  std::vector<Real> dashpot = std::vector<Real>(RockDamping<Shape>::dashpot_rows * this->stride);
  std::vector<Real> work = std::vector<Real>(this->stride);
  std::vector<Real> stress = std::vector<Real>(6 * this->stride);
  std::vector<Real> energy = std::vector<Real>(this->stride);
  std::vector<Real> corner_force = std::vector<Real>(4 * Shape::nodes * this->stride);
  Real dt = 0.01;
  bool branches = true, dashpots = true;

  RockDamping<Shape> damping(bool ahead = false) {
    const Real time = 0.3;
    return {.branch = {branches ? branch.data() : nullptr, this->stride},
            .dashpot = {dashpots ? dashpot.data() : nullptr, this->stride},
            .ahead = ahead,
            .dt = dt,
            .per_step = time / dt,
            .maxwell = {{.weight = {0.2, 0.3, 0.4}, .rate = {1, 5, 20}}, dt}};
  }
  CorotationalForce<Shape, FollowRotation, PointFlow<Shape>, RockDamping<Shape>> kernel() {
    return {this->columns(),
            0,
            dt,
            {work.data(), this->stride},
            {{nullptr, this->stride}, {nullptr, this->stride}, dt},
            damping()};
  }
  CorotationalReport<Shape, FollowRotation, PointFlow<Shape>, RockDamping<Shape>> report(
      bool ahead) {
    return {this->columns(),
            {stress.data(), this->stride},
            {energy.data(), this->stride},
            {nullptr, this->stride},
            {{nullptr, this->stride}, {nullptr, this->stride}, dt},
            damping(ahead)};
  }
  void update() { this->run(kernel(), corner_force); }
  Vec force(Index e, Index k) const {
    return vector_at(corner_force.data() + 4 * (e * Shape::nodes + k));
  }
  /// Move every node to a place in one step.
  template <class Place>
  void move_to(const Place& place) {
    for (Index e = 0; e < this->count; ++e)
      for (Index k = 0; k < Shape::nodes; ++k) {
        const Vec x = place(e, k);
        this->move(e, k, Real(1 / dt) * (x - this->position(e, k)));
        this->place(e, k, x);
      }
  }
};

}  // namespace

TEST_CASE_TEMPLATE("a turning element is not damped, strained or not", Shape, ALL_SHAPES) {
  for (const Real strain : {0.0, 1e-3}) {
    Random random(1);
    Damped<Shape> elements(lanes + 1, random);
    const Mat stretch = random.stretch(strain);
    const auto turned = [&](Real angle) {
      const Mat turn{
          {std::cos(angle), -std::sin(angle), 0}, {std::sin(angle), std::cos(angle), 0}, {0, 0, 1}};
      return [&elements, turn, stretch](Index e, Index k) {
        return turn * (stretch * elements.rest(e, k));
      };
    };
    elements.move_to(turned(0));
    for (Index n = 1; n <= 20; ++n) {
      elements.move_to(turned(0.1 * n));
      elements.update();
    }
    for (const Real z : elements.branch) CHECK(std::abs(z) < 1e-14);
    // the rates of hourglass modes turn with a strained element: their work is of its strain
    // squared
    for (Index row = 0; row < 6 * Shape::points; ++row)
      for (Index e = 0; e < elements.count; ++e)
        CHECK(std::abs(elements.dashpot[row * elements.stride + e]) < 1e-12 * modulus_scale);
    if (!Shape::hourglass)
      for (const Real lost : elements.work) CHECK(std::abs(lost) < 1e-24 * modulus_scale);
  }
}

TEST_CASE_TEMPLATE("damped elements one by one and in lanes: the same bits", Shape, ALL_SHAPES) {
  Random random(2);
  Damped<Shape> elements(8 + 2 * lanes + 1, random);
  const auto shake = [&] {
    elements.move_to([&](Index e, Index k) { return elements.rest(e, k) + random.vector(0.01); });
  };
  shake();
  elements.update();
  const auto branch = elements.branch, dashpot = elements.dashpot, work = elements.work;
  shake();
  elements.update();
  const auto force = elements.corner_force, branch2 = elements.branch, work2 = elements.work,
             dashpot2 = elements.dashpot;
  elements.branch = branch, elements.dashpot = dashpot, elements.work = work;
  for (Index e = 0; e < elements.count; ++e)
    elements.kernel().forces(One{e}).store({elements.corner_force.data()}, One{e});
  CHECK(elements.corner_force == force);
  CHECK(elements.branch == branch2);
  CHECK(elements.dashpot == dashpot2);
  CHECK(elements.work == work2);
}

TEST_CASE_TEMPLATE("damped forces of an element sum to no force and no moment", Shape, ALL_SHAPES) {
  Random random(3);
  Damped<Shape> elements(3 * lanes, random);
  elements.dashpots = false;  // of hourglass modes they have a moment of the strain
  for (Index n = 0; n < 3; ++n) {
    elements.move_to([&](Index e, Index k) { return elements.rest(e, k) + random.vector(0.01); });
    elements.update();
  }
  Real worst_f = 0, worst_m = 0;
  for (Index e = 0; e < elements.count; ++e) {
    Vec sum{0, 0, 0}, moment{0, 0, 0};
    for (Index k = 0; k < Shape::nodes; ++k) {
      sum = sum + elements.force(e, k);
      moment = moment + cross(elements.position(e, k), elements.force(e, k));
    }
    worst_f = std::max(worst_f, norm(sum));
    worst_m = std::max(worst_m, norm(moment));
  }
  CHECK(worst_f < 1e-16 * modulus_scale);
  CHECK(worst_m < 1e-15 * modulus_scale);
}

TEST_CASE_TEMPLATE("what the mean force of each step supplies is stored or lost", Shape,
                   ALL_SHAPES) {
  Random random(4);
  for (const bool branches : {true, false}) {
    Damped<Shape> elements(1, random);
    elements.branches = branches, elements.dashpots = !branches;
    std::vector<Vec> way;
    for (Index k = 0; k < Shape::nodes; ++k) way.push_back(random.vector(1e-7));
    Real supplied = 0;
    std::vector<Vec> before(Shape::nodes, Vec{0, 0, 0});
    for (Index n = 1; n <= 60; ++n) {
      elements.move_to(
          [&](Index e, Index k) { return elements.rest(e, k) + Real(std::sin(0.3 * n)) * way[k]; });
      elements.update();
      for (Index k = 0; k < Shape::nodes; ++k) {
        supplied -=
            0.5 * elements.dt * dot(before[k] + elements.force(0, k), elements.velocity(0, k));
        before[k] = elements.force(0, k);
      }
    }
    elements.report(false)(One{0});
    CHECK(elements.work[0] > 0.1 * elements.energy[0]);
    CHECK(relative_error(elements.energy[0] + elements.work[0], supplied) < 3e-6);
  }
}

TEST_CASE("branches relax as their equation says, and the report runs ahead by a step") {
  Random random(5);
  Damped<Tet4> tet(1, random);
  tet.dashpots = false;
  const Mat stretch{{1.00001, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tet.move_to([&](Index e, Index k) { return stretch * tet.rest(e, k); });
  tet.update();  // E grows evenly in the step, then stays
  const auto damping = tet.damping();
  for (Index j = 0; j < 3; ++j)
    CHECK(relative_error(tet.branch[6 * j * tet.stride], 1e-5 * damping.maxwell.share[j]) < 1e-9);
  for (Index n = 0; n < 4; ++n) {
    tet.move_to([&](Index e, Index k) { return tet.position(e, k); });
    tet.report(true)(One{0});
    const Real ahead = tet.stress[0], stored = tet.energy[0];
    tet.update();
    tet.report(false)(One{0});
    CHECK(same_bits(tet.stress[0], ahead));
    CHECK(same_bits(tet.energy[0], stored));
  }
  for (Index j = 0; j < 3; ++j)
    CHECK(relative_error(tet.branch[6 * j * tet.stride],
                         1e-5 * damping.maxwell.share[j] * std::pow(damping.maxwell.left[j], 4)) <
          1e-9);
}

TEST_CASE("dashpots bear their time times the rate of the strain") {
  Random random(6);
  Damped<Hex8> cube(1, random, 0);
  cube.branches = false;
  const Mat stretch{{1 + 1e-6, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  cube.move_to([&](Index e, Index k) { return stretch * cube.rest(e, k); });
  cube.update();
  const Real rate = 1e-6 / cube.dt, modulus = cube.lambda[0] + 2 * cube.mu[0];
  CHECK(relative_error(cube.dashpot[0], 0.3 * modulus * rate) < 1e-9);
  CHECK(relative_error(cube.work[0], 0.5 * 0.3 * modulus * rate * rate * cube.dt * 8) < 1e-5);
}

}  // namespace cdem::test
