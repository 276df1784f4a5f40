// The normal spring of joints that close by a hyperbola, and then in a straight line.
#include "core/interfaces/closure.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

constexpr Real initial = 15.35e9, most = 0.227e-3;  // [Pa/m], [m]
constexpr HyperbolicClosure<Real> spring{.initial = initial, .most = most};
const auto stiff = JointStiffness<Real>::of(1e12, 1e9);

}  // namespace

TEST_CASE("sigma = k_i d / (1 - d / V_m) until it is as stiff as k_n") {
  for (const Real part : {0.01, 0.3, 0.8}) {
    const Real d = part * most, sigma = initial * d / (1 - part);
    CHECK(relative_error(spring.close(d, stiff).pressure, sigma) < 1e-15);
    CHECK(relative_error(spring.tangent(sigma, stiff), initial / ((1 - part) * (1 - part))) <
          1e-14);
  }
  const Real end = spring.end(1e12);
  CHECK(relative_error(spring.tangent(end, stiff), 1e12) < 1e-14);
  const Real at = spring.depth(end, stiff);
  CHECK(relative_error(at, end / (initial + end / most)) < 1e-14);
  CHECK(relative_error(spring.close(at + 1e-4, stiff).pressure, end + 1e8) < 1e-14);
  CHECK(spring.tangent(2 * end, stiff) == 1e12);
}

TEST_CASE("depth is the inverse of closing, and what is stored is the area under the curve") {
  Real stored = 0, before = 0;
  for (Index k = 1; k <= 4000; ++k) {
    const Real d = 1e-7 * k;  // past the end of the curve
    const Closure<Real> closed = spring.close(d, stiff);
    stored += 0.5e-7 * (before + closed.pressure);
    before = closed.pressure;
    if (k % 500 != 0) continue;
    CHECK(relative_error(spring.depth(closed.pressure, stiff), d) < 1e-14);
    CHECK(relative_error(closed.stored, stored) < 1e-5);
  }
}

TEST_CASE("where k_n is below k_i the spring is straight") {
  const auto soft = JointStiffness<Real>::of(1e9, 1e9);
  const Closure<Real> own = spring.close(1e-4, soft), straight = close_straight(1e-4, soft);
  CHECK(relative_error(own.pressure, straight.pressure) < 1e-15);
  CHECK(relative_error(own.stored, straight.stored) < 1e-15);
  CHECK(spring.end(1e9) == 0);
  CHECK(relative_error(spring.depth(1e5, soft), 1e-4) < 1e-15);
}

}  // namespace cdem::test
