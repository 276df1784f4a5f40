// The approximate inverse is symmetric and positive, and close enough to solve with.
#include "core/rest/conjugate_gradients.hpp"
#include "core/rest/multigrid.hpp"
#include "core/rest/tangent.hpp"
#include "tests/core/rest/wall.hpp"

namespace cdem::test {

namespace {

Real dot(const Column<Real>& a, const Column<Real>& b) {
  Real sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += on_host(a)[i] * on_host(b)[i];
  return sum;
}

/// A random vector that is zero where nothing may move.
Column<Real> vector(Random& random, const std::vector<Flag>& free) {
  Column<Real> x;
  x.resize(free.size());
  for (std::size_t i = 0; i < free.size(); ++i) on_host(x)[i] = free[i] ? random.between(-1, 1) : 0;
  return x;
}

}  // namespace

TEST_CASE("it is symmetric and positive") {
  Random random(6);
  Wall wall;
  NodeSystem t = tangent_of(wall.model, wall.state);
  const Column<Real> r = vector(random, t.free), s = vector(random, t.free);
  Column<Real> z, y;
  z.resize(r.size());
  y.resize(r.size());
  Multigrid inverse(std::move(t));
  CHECK(inverse.levels() > 1);
  inverse.apply({}, r.data(), z.data());
  inverse.apply({}, s.data(), y.data());
  CHECK(dot(z, s) == doctest::Approx(dot(r, y)).epsilon(1e-10));
  CHECK(dot(z, r) > 0);
}

TEST_CASE("conjugate gradients solve in few iterations; of nothing, in none") {
  Random random(7);
  Wall wall;
  NodeSystem t = tangent_of(wall.model, wall.state);
  const Column<Real> b = vector(random, t.free);
  Multigrid inverse(std::move(t));
  GradientVectors v;
  v.r.assign(fetch(b));
  const int iterations = solve_by_gradients({}, inverse, 1e-8, 100, v);
  CHECK(iterations > 1);
  CHECK(iterations < 30);
  Column<Real> rest;
  rest.resize(b.size());
  residual({}, inverse.matrix(), b.data(), v.x.data(), rest.data());
  CHECK(dot(rest, rest) < 2e-16 * dot(b, b));
  v.r.assign(fetch(b));
  CHECK(solve_by_gradients({}, inverse, 1e-8, 2, v) == -1);
  for (Real& one : on_host(v.r)) one = 0;
  CHECK(solve_by_gradients({}, inverse, 1e-8, 100, v) == 0);
}

}  // namespace cdem::test
