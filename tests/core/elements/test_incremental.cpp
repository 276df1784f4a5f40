// Element forces from the step's displacement increment.
#include "core/base/parallel.hpp"
#include "core/elements/incremental.hpp"
#include "tests/core/elements/reference.hpp"

namespace cdem::test {

namespace {

constexpr Real stiff = 1e10;  // forces and stresses are compared with this

/// Elements with the tables that the kernels write.
template <class Shape, class Turning>
struct Loaded : Elements<Shape> {
  using Elements<Shape>::Elements;
  std::vector<Real> stress = std::vector<Real>(6 * Shape::points * this->stride);
  std::vector<Real> energy = std::vector<Real>(this->stride);
  std::vector<Real> corner_force = std::vector<Real>(4 * Shape::nodes * this->stride);
  Real dt = 0.1;

  IncrementalForce<Shape, Turning> kernel() {
    return {this->columns(), dt, {stress.data(), this->stride}, {energy.data(), this->stride}};
  }
  void update() { this->run(kernel(), corner_force); }
  /// Go to new places in one step.
  template <class Place>
  void step(const Place& place) {
    for (Index e = 0; e < this->count; ++e)
      for (Index k = 0; k < Shape::nodes; ++k) {
        const Vec before = this->position(e, k), now = place(e, k);
        this->place(e, k, now);
        this->move(e, k, Real(1 / dt) * (now - before));
      }
    update();
  }
  Real& component(Index e, Index q, Index row) { return stress[(6 * q + row) * this->stride + e]; }
  Sym3<Real> stress_at(Index e, Index q) {
    const auto s = [&](Index row) { return component(e, q, row); };
    return {s(0), s(1), s(2), s(3), s(4), s(5)};
  }
  Vec force(Index e, Index k) const {
    return vector_at(corner_force.data() + 4 * (e * Shape::nodes + k));
  }
};

#define ALL_SHAPES Tet4, Pyramid5, Wedge6, Hex8, Hex8OnePoint

/// A rotation by an angle about an axis.
Mat turn_by(const Vec& axis, Real angle) {
  const Real s = std::sin(angle), c = std::cos(angle);
  Mat m = c * identity<Real>();
  add_outer(m, Real(1 - c) * axis, axis);
  return m + s * Mat{{0, -axis.z, axis.y}, {axis.z, 0, -axis.x}, {-axis.y, axis.x, 0}};
}

}  // namespace

TEST_CASE_TEMPLATE("a rigid rotation turns the stress and does no work", Shape, ALL_SHAPES) {
  Random random(1);
  Loaded<Shape, TurnByHalves> elements(lanes + 1, random);
  const Sym3<Real> stress = Real(1e8) * symmetric(random.matrix(1));
  for (Index e = 0; e < elements.count; ++e)
    for (Index q = 0; q < Shape::points; ++q) {
      const Real s[6] = {stress.xx, stress.yy, stress.zz, stress.xy, stress.yz, stress.zx};
      for (Index row = 0; row < 6; ++row) elements.component(e, q, row) = s[row];
    }
  const Mat turn = turn_by(random.direction(), 0.01);
  elements.step([&](Index e, Index k) { return turn * elements.rest(e, k); });
  const Mat turned = turn * full(stress) * transpose(turn);
  for (Index e = 0; e < elements.count; ++e) {
    for (Index q = 0; q < Shape::points; ++q) {
      const Sym3<Real> now = elements.stress_at(e, q);
      // an angle is turned by 4 atan(tan(angle / 2) / 2): angle^3 / 16 less
      CHECK(distance(full(now), turned) < 3e-7 * 1e8);
      CHECK(std::abs(trace(now) - trace(stress)) < 2e-13 * 1e8);
      CHECK(relative_error(contract(now, now), contract(stress, stress)) < 1e-13);
    }
    CHECK(std::abs(elements.energy[e]) < 2e-15 * 1e8);
  }
}

TEST_CASE_TEMPLATE("a small stretch from rest gives the stress and energy of the law", Shape,
                   ALL_SHAPES) {
  Random random(2);
  const Rock rock;
  Loaded<Shape, TurnByHalves> halves(lanes + 1, random, 0.15, rock);
  Loaded<Shape, NeverTurn> never(lanes + 1, random, 0.15, rock);
  constexpr Real size = 1e-6;
  const Sym3<Real> strain = size * symmetric(random.matrix(1));
  const Mat stretch = identity<Real>() + full(strain);
  const Mat stress =
      rock.lambda * trace(strain) * identity<Real>() + Real(2 * rock.mu) * full(strain);
  const auto check = [&](auto& elements) {
    elements.step([&](Index e, Index k) { return stretch * elements.rest(e, k); });
    for (Index e = 0; e < elements.count; ++e) {
      for (Index q = 0; q < Shape::points; ++q)
        CHECK(distance(full(elements.stress_at(e, q)), stress) < 1e-5 * size * stiff);
      const Real energy =
          0.5 * elements.geometry[e].whole() *
          (rock.lambda * trace(strain) * trace(strain) + 2 * rock.mu * contract(strain, strain));
      CHECK(relative_error(elements.energy[e], energy) < 5e-6);
    }
  };
  check(halves);
  check(never);
}

TEST_CASE_TEMPLATE("forces sum to no force and no moment", Shape, ALL_SHAPES) {
  Random random(3);
  Loaded<Shape, TurnByHalves> elements(lanes + 1, random);
  for (Index n = 0; n < 3; ++n)
    elements.step([&](Index e, Index k) { return elements.position(e, k) + random.vector(0.01); });
  for (Index e = 0; e < elements.count; ++e) {
    Vec sum{0, 0, 0}, moment{0, 0, 0};
    for (Index k = 0; k < Shape::nodes; ++k) {
      sum = sum + elements.force(e, k);
      moment = moment + cross(elements.position(e, k), elements.force(e, k));
    }
    CHECK(norm(sum) < 3e-17 * stiff);
    CHECK(norm(moment) < 1e-16 * stiff);
  }
}

TEST_CASE_TEMPLATE("the incremental forms agree with the total one for small steps", Shape,
                   ALL_SHAPES) {
  Random random(4);
  Loaded<Shape, TurnByHalves> elements(lanes + 1, random);
  elements.step([&](Index e, Index k) { return elements.rest(e, k) + random.vector(1e-6); });
  for (Index e = 0; e < elements.count; ++e) {
    // stiffness times displacement, from the law at every point
    const auto columns = elements.columns();
    Sym3<Real> strain[Shape::points];
    CornerForces<Shape, Real> expected;
    const auto arms = position_arms(columns, One{e});
    for (Index q = 0; q < Shape::points; ++q)
      strain[q] = symmetric(gradient_of(columns, One{e}, q, arms) - identity<Real>());
    use_mean_dilatation<Shape>(columns, One{e}, strain);
    for (Index q = 0; q < Shape::points; ++q)
      expected.add(
          columns, One{e}, q,
          elements.geometry[e].volume[q] * full(columns.elastic(One{e}).stress(strain[q])));
    if constexpr (Shape::hourglass)
      Hourglass<Real>(columns, One{e}, arms).add(columns, One{e}, 1.0, expected);
    for (Index k = 0; k < Shape::nodes; ++k)
      CHECK(distance(elements.force(e, k), expected.f[k]) < 1e-11 * stiff);
  }
}

TEST_CASE_TEMPLATE("one by one and in lanes the bits are the same", Turning, TurnByHalves,
                   NeverTurn) {
  Random random(5);
  Loaded<Wedge6, Turning> in_lanes(2 * lanes + 1, random);
  in_lanes.step([&](Index e, Index k) { return in_lanes.rest(e, k) + random.vector(0.02); });
  Random again(5);
  Loaded<Wedge6, Turning> one_by_one(2 * lanes + 1, again);
  one_by_one.motion = in_lanes.motion;
  for (Index e = 0; e < one_by_one.count; ++e)
    one_by_one.kernel().forces(One{e}).store({one_by_one.corner_force.data()}, One{e});
  CHECK(one_by_one.corner_force == in_lanes.corner_force);
  CHECK(one_by_one.energy == in_lanes.energy);
  CHECK(one_by_one.stress == in_lanes.stress);
}

}  // namespace cdem::test
