// Gradients, corner forces, hourglass modes and mean dilatation of the element shapes.
#include "core/elements/shapes.hpp"
#include "tests/core/elements/reference.hpp"

namespace cdem::test {

TEST_CASE_TEMPLATE("an affine motion has the same gradient at every Gauss point", Shape, Tet4,
                   Pyramid5, Wedge6, Hex8, Hex8OnePoint) {
  Random random(1);
  Elements<Shape> elements(20, random);
  const Mat f = random.matrix(1);
  const Vec shift = random.vector(10);
  for (Index e = 0; e < elements.count; ++e)
    for (Index k = 0; k < Shape::nodes; ++k) {
      elements.place(e, k, f * elements.rest(e, k) + shift);
      elements.move(e, k, f * elements.rest(e, k));
    }
  const auto columns = elements.columns();
  for (Index e = 0; e < elements.count; ++e)
    for (Index q = 0; q < Shape::points; ++q) {
      CHECK(distance(gradient_of(columns, One{e}, q, position_arms(columns, One{e})), f) < 2e-14);
      CHECK(distance(gradient_of(columns, One{e}, q, velocity_arms(columns, One{e})), f) < 3e-15);
    }
}

TEST_CASE_TEMPLATE("corner forces of any stress sum to zero", Shape, Tet4, Pyramid5, Wedge6, Hex8,
                   Hex8OnePoint) {
  Random random(2);
  const Elements<Shape> elements(20, random);
  for (Index e = 0; e < elements.count; ++e) {
    CornerForces<Shape, Real> force;
    for (Index q = 0; q < Shape::points; ++q)
      force.add(elements.columns(), One{e}, q, random.matrix(1));
    Vec sum{0, 0, 0};
    for (Index k = 0; k < Shape::nodes; ++k) sum = sum + force.f[k];
    CHECK(norm(sum) < 1e-14);
  }
}

TEST_CASE("a uniform stress pulls at each face of a cube with its area") {
  Random random(3);
  const Elements<Hex8> cube(1, random, 0);  // 2 m
  CornerForces<Hex8, Real> force;
  const Mat stress{{1, 2, 3}, {2, 4, 5}, {3, 5, 6}};
  for (Index q = 0; q < 8; ++q)
    force.add(cube.columns(), One{0}, q, cube.geometry[0].volume[q] * stress);
  for (Index k = 0; k < 8; ++k)  // a quarter of the three faces that meet there, 1 m2 each
    CHECK(distance(force.f[k], Real(-1) * (stress * Reference<Hex8>::corners()[k])) < 5e-14);
}

TEST_CASE("hourglass modes do not feel an affine motion, whatever the rotation") {
  Random random(4);
  Elements<Hex8OnePoint> elements(20, random);
  const Mat f = random.rotation() * random.stretch(0.3);
  for (Index e = 0; e < elements.count; ++e) {
    for (Index k = 0; k < 8; ++k) elements.place(e, k, f * elements.rest(e, k));
    const auto columns = elements.columns();
    const Hourglass<Real> modes(columns, One{e}, position_arms(columns, One{e}));
    CHECK(modes.square() < 3e-29);
  }
}

TEST_CASE("hourglass springs let a cube of one point bend like a beam") {
  Random random(5);
  const Rock rock;
  Elements<Hex8OnePoint> cube(1, random, 0, rock);
  constexpr Real side = 2, curvature = 1e-3;
  for (Index k = 0; k < 8; ++k) {
    const Vec x = cube.rest(0, k);
    cube.place(0, k, x + Vec{curvature * x.x * x.z, 0, 0});
  }
  const auto columns = cube.columns();
  const Hourglass<Real> modes(columns, One{0}, position_arms(columns, One{0}));
  const Real inertia = std::pow(side, 4) / 12;
  CHECK(relative_error(0.5 * modes.stiffness * modes.square(),
                       0.5 * rock.young_modulus() * inertia * curvature * curvature * side) <
        5e-13);
}

TEST_CASE("hourglass forces are the derivative of their energy") {
  Random random(6);
  Elements<Hex8OnePoint> elements(1, random);
  const auto columns = elements.columns();
  const auto energy = [&] {
    const Hourglass<Real> modes(columns, One{0}, position_arms(columns, One{0}));
    return 0.5 * modes.stiffness * modes.square();
  };
  for (Index k = 0; k < 8; ++k) elements.place(0, k, elements.rest(0, k) + random.vector(0.1));
  CornerForces<Hex8OnePoint, Real> force;
  Hourglass<Real>(columns, One{0}, position_arms(columns, One{0})).add(columns, One{0}, 1.0, force);
  const Real scale = elements.hourglass[12 * elements.stride];  // stiffness
  for (Index k = 0; k < 8; ++k) {
    const Vec way = random.direction(), x = elements.position(0, k);
    constexpr Real step = 1e-3;  // the energy is quadratic
    elements.place(0, k, x + step * way);
    const Real ahead = energy();
    elements.place(0, k, x - step * way);
    const Real behind = energy();
    elements.place(0, k, x);
    CHECK(std::abs(dot(force.f[k], way) + (ahead - behind) / (2 * step)) < 1e-12 * scale);
  }
}

TEST_CASE("mean dilatation changes the trace of each point to the mean, and nothing else") {
  Random random(7);
  const Elements<Hex8> elements(1, random);
  Sym3<Real> strain[8], before[8];
  Real mean = 0, volume = 0;
  for (Index q = 0; q < 8; ++q) {
    before[q] = strain[q] = symmetric(random.matrix(0.01));
    mean += elements.geometry[0].volume[q] * trace(strain[q]);
    volume += elements.geometry[0].volume[q];
  }
  mean /= volume;
  use_mean_dilatation<Hex8>(elements.columns(), One{0}, strain);
  for (Index q = 0; q < 8; ++q) {
    CHECK(std::abs(trace(strain[q]) - mean) < 1e-17);
    CHECK(strain[q].xy == before[q].xy);
    CHECK(std::abs(strain[q].xx - strain[q].zz - (before[q].xx - before[q].zz)) < 2e-18);
  }
}

}  // namespace cdem::test
