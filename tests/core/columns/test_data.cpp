// The module of columns.
#include <cmath>
#include <vector>

#include "core/columns/data.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("the highest frequency of columns that move is at least that of their chains") {
  ColumnSet g;
  g.count = 2;
  g.level_first.assign({0, 3, 5});
  // the first column: springs 6 and 12, masses 3, 3, 2; the second is stiffer, and is held
  g.layer.assign({2, 12, 4, 6, 0.5, 6, 2, 3, 1, 1, 0, 0, 1, 900, 1, 1, 1, 1, 0, 0});
  g.mass.assign({3, 3, 2, 1, 1});
  g.acts.assign({1, 0});
  // K - w2 M of the chain: w2 = 0 and the roots of w2^2 - sum w2 + product
  g.bond.assign({0, 1, 0, 0, 0});
  const Real bound = Columns::frequency_squared(g, 1);
  CHECK(bound == doctest::Approx(12));  // 2 * 6 / 3, 2 * 18 / 3, 2 * 12 / 2
  const Real a = 6, b = 12, sum = a / 3 + (a + b) / 3 + b / 2, product = a * b * 8 / (3 * 3 * 2);
  const Real highest = 0.5 * (sum + std::sqrt(sum * sum - 4 * product));
  CHECK(bound >= highest);
  // rock alone is stiffer in fast motion: 2 * (12 + 12) / 3
  CHECK(Columns::frequency_squared(g, 2) == doctest::Approx(16));
  g.acts.assign({1, 1});
  CHECK(Columns::frequency_squared(g, 1) == doctest::Approx(1800));
}

}  // namespace cdem::test
