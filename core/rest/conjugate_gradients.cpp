// conjugate_gradients.cpp - see conjugate_gradients.hpp.
#include "core/rest/conjugate_gradients.hpp"

#include "core/base/primitives.hpp"
#include "core/rest/products.hpp"

namespace cdem {

namespace {

Real dot(Queue q, const Column<Real>& a, const Column<Real>& b) {
  return exact_sum(q, Index(a.size() / 3), DotOfThree{a.data(), b.data()}, {});
}

/// y = a x + b y
void combine(Queue q, Real a, const Column<Real>& x, Real b, Column<Real>& y) {
  for_each_item(q, Index(y.size()), Combine{.a = a, .b = b, .x = x.data(), .y = y.data()});
}

}  // namespace

int solve_by_gradients(Queue q, Multigrid& inverse, Real part, int most_iterations,
                       GradientVectors& v) {
  for (Column<Real>* one : {&v.x, &v.z, &v.p, &v.product}) one->renew(v.r.size());
  set_all(q, Index(v.x.size()), v.x.data(), 0.0);
  const Real limit = part * part * dot(q, v.r, v.r);
  if (!(limit > 0)) return 0;
  set_all(q, Index(v.p.size()), v.p.data(), 0.0);
  Real before = 1;
  for (int n = 1; n <= most_iterations; ++n) {
    inverse.apply(q, v.r.data(), v.z.data());
    const Real now = dot(q, v.r, v.z);
    combine(q, 1, v.z, n == 1 ? 0 : now / before, v.p);
    multiply(q, inverse.matrix(), v.p.data(), v.product.data());
    const Real curvature = dot(q, v.p, v.product);
    if (!(curvature > 0) || !(now > 0)) return -1;
    combine(q, now / curvature, v.p, 1, v.x);
    combine(q, -now / curvature, v.product, 1, v.r);
    if (dot(q, v.r, v.r) <= limit) return n;
    before = now;
  }
  return -1;
}

}  // namespace cdem
