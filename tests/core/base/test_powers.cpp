// Exponential, logarithm and powers against the library's, and a lane against its numbers.
#include "core/base/powers.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("exponential and logarithm are exact but for two units in the last place") {
  Random random(1);
  Real worst_exp = 0, worst_log = 0;
  for (int k = 0; k < 100000; ++k) {
    const Real range[] = {1e-8, 1, 30, 690}, x = random.between(-1, 1) * range[k % 4];
    worst_exp = std::max(worst_exp, relative_error(exp_of(x), Real(std::exp((long double)x))));
    const Real y = k % 2 ? std::exp(x) : 1 + 0.1 * random.between(-1, 1);
    const Real known = Real(std::log((long double)y));
    worst_log = std::max(worst_log, std::abs(log_of(y) - known) / std::max(std::abs(known), 1e-12));
  }
  CHECK(worst_exp < 4.5e-16);
  CHECK(worst_log < 4.5e-16);
  CHECK(exp_of(0.0) == 1);
  CHECK(log_of(1.0) == 0);
}

TEST_CASE("powers") {
  CHECK(relative_error(pow_of(3e-6, 0.505734), std::pow(3e-6, 0.505734)) < 3e-15);
  CHECK(relative_error(pow_of(40.0, -0.5), 1 / std::sqrt(40.0)) < 2e-15);
}

TEST_CASE("powers of a lane are those of its numbers") {
  Random random(2);
  check_lanes<2, 3>(
      [](const auto* in, auto* out) {
        out[0] = exp_of(in[1]), out[1] = log_of(in[0]), out[2] = pow_of(in[0], in[1]);
      },
      [&](Real* in) { in[0] = std::exp(random.between(-40, 40)), in[1] = random.between(-9, 9); });
}

}  // namespace cdem::test
