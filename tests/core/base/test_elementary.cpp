// Exponential function, logarithm and power against numbers of 20 digits, and lane by lane.
#include <cmath>

#include "core/base/elementary.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("exp_of meets 17 digits of the exponential function") {
  constexpr Real table[][2] = {
      {-700.0, 9.85967654375977085671e-305}, {-20.5, 1.25015286638674262894e-9},
      {-1.0, 3.67879441171442321596e-1},     {-0.3, 7.40818220681717874292e-1},
      {0.0, 1.00000000000000000000e+0},      {1e-09, 1.00000000100000000050e+0},
      {0.34657, 1.41420848495957966219e+0},  {0.5, 1.64872127070012814685e+0},
      {1.0, 2.71828182845904523536e+0},      {10.0, 2.20264657948067165170e+4},
      {700.0, 1.01423205473500450946e+304}};
  for (const auto& [x, exact] : table) CHECK(relative_error(exp_of(x), exact) < 4.5e-16);
  CHECK(exp_of(-1e9) == exp_of(-700.0));
  CHECK(exp_of(1e9) == exp_of(700.0));
}

TEST_CASE("log_of meets 17 digits of the logarithm") {
  constexpr Real table[][2] = {
      {1e-300, -6.90775527898213705180e+2}, {0.001, -6.90775527898213703124e+0},
      {0.5, -6.93147180559945309417e-1},    {0.70711, -3.46569038200694120289e-1},
      {0.999, -1.00050033358353438921e-3},  {1.001, 9.99500333083423142709e-4},
      {1.5, 4.05465108108164381978e-1},     {2.0, 6.93147180559945309417e-1},
      {10.0, 2.30258509299404568402e+0},    {1e+300, 6.90775527898213705258e+2}};
  for (const auto& [x, exact] : table)
    CHECK(std::abs(log_of(x) - exact) < 4.5e-16 * std::abs(exact) + 1e-16);
  CHECK(log_of(1.0) == 0);
}

TEST_CASE("exponential function and logarithm undo each other; powers multiply") {
  Random random(1);
  for (int k = 0; k < 1000; ++k) {
    const Real x = random.between(-300, 300), y = random.between(-2, 2);
    CHECK(std::abs(log_of(exp_of(x)) - x) < 1e-15 * (1 + std::abs(x)));
    const Real a = random.between(0.01, 100);
    CHECK(relative_error(pow_of(a, y) * pow_of(a, -y), 1) < 1e-14);
  }
  CHECK(relative_error(pow_of(2.0, 0.5), 1.4142135623730951) < 4.5e-16);
}

TEST_CASE("tan_of meets 17 digits of the tangent") {
  constexpr Real table[][2] = {{1e-09, 1e-09},
                               {0.1, 0.10033467208545055},
                               {0.5, 0.5463024898437905},
                               {1.0, 1.5574077246549023},
                               {1.2, 2.5721516221263188},
                               {1.3, 3.6021024479679786}};
  for (const auto& [x, exact] : table) CHECK(relative_error(tan_of(x), exact) < 2e-15);
  CHECK(tan_of(0.0) == 0);
}

TEST_CASE("lanes have the bits of their numbers") {
  Random random(2);
  check_lanes<2, 4>(
      [](const auto* in, auto* out) {
        out[0] = exp_of(in[0]), out[1] = log_of(in[1]), out[2] = pow_of(in[1], in[0]);
        out[3] = tan_of(in[0]);
      },
      [&](Real* in) { in[0] = random.between(-5, 5), in[1] = exp_of(random.between(-50, 50)); });
}

}  // namespace cdem::test
