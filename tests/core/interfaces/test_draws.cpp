// Draws of the strength of pairs.
#include <cmath>

#include "core/interfaces/draws.hpp"
#include "core/interfaces/laws.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("a draw depends on the seed and the two faces in any order") {
  CHECK(uniform_draw(1, 4, 9) == uniform_draw(1, 9, 4));
  CHECK(uniform_draw(1, 4, 9) != uniform_draw(2, 4, 9));
  CHECK(uniform_draw(1, 4, 9) != uniform_draw(1, 4, 10));
  CHECK(uniform_draw(1, 4, 9) != uniform_draw(1, 5, 9));
  CHECK(uniform_draw(7, 0, 1) == 0.7642824559724547);  // the same on every machine
}

TEST_CASE("draws are uniform, one by one and from one to the next") {
  constexpr Index count = 100000;
  Real sum = 0, squares = 0, products = 0, before = 0.5;
  for (Index k = 0; k < count; ++k) {
    const Real u = uniform_draw(3, k, k + 1) - 0.5;
    sum += u, squares += u * u, products += u * before, before = u;
  }
  CHECK(std::abs(sum / count) < 3 / std::sqrt(12.0 * count));
  CHECK(std::abs(squares / count - 1 / 12.0) < 3 / std::sqrt(180.0 * count));
  CHECK(std::abs(products / count) < 3 / 12.0 / std::sqrt(Real(count)));
}

TEST_CASE("factors are of Weibull's distribution: mean 1, as many below its median as above") {
  const Real shape = 5, mean = std::tgamma(1 + 1 / shape);
  constexpr Index count = 100000;
  Real sum = 0, below = 0;
  for (Index k = 0; k < count; ++k) {
    const Real w = weibull_factor(3, k, k + 1, shape, mean);
    sum += w, below += w < std::pow(std::log(2.0), 1 / shape) / mean;
  }
  CHECK(std::abs(sum / count - 1) < 3 * 0.2291 / std::sqrt(Real(count)));
  CHECK(std::abs(below / count - 0.5) < 1.5 / std::sqrt(Real(count)));
}

TEST_CASE("strengths have the factor, fracture energies its square, all else stays") {
  Real numbers[parameter_row];
  for (Real& n : numbers) n = 3;
  Scatter<Real>{true, 0.5}.scale<Softening>(numbers);
  for (Index k = 0; k < Index(Softening<Real>::parameters.size()); ++k) {
    const std::string_view name = Softening<Real>::parameters[k].name;
    const bool energy = name.starts_with("fracture_energy");
    const bool strength = name.ends_with("cohesion") || name == "tensile_strength";
    CHECK(numbers[k] == (energy ? 0.75 : strength ? 1.5 : 3));
  }
}

}  // namespace cdem::test
