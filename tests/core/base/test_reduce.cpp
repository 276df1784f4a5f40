// Sums do not depend on the number of threads.
#include <omp.h>

#include "core/base/reduce.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("ordered_sum has the same bits on any number of threads") {
  Random random(1);
  Column<Real> numbers;
  for (Index i = 0; i < 5000; ++i) numbers.push(random.between(-1, 1) * std::pow(10.0, i % 17));
  const int threads = omp_get_max_threads();
  for (const Index count : {0, 1, 1023, 1024, 1025, 2048, 5000}) {
    const auto sum = [&](int on) {
      omp_set_num_threads(on);
      return ordered_sum(count, [&](Index i) { return numbers[i]; });
    };
    const Real alone = sum(1);
    for (const int on : {2, 3, 7}) CHECK(same_bits(sum(on), alone));
  }
  omp_set_num_threads(threads);
}

TEST_CASE("ordered_sum takes every term once") {
  for (const Index count : {0, 1, 1023, 1024, 1025, 5000})
    CHECK(ordered_sum(count, [](Index i) { return Real(i); }) == 0.5 * count * (count - 1.0));
  Column<Real> ones;
  ones.resize(3000, 1.0);
  CHECK(column_sum(ones) == 3000);
}

}  // namespace cdem::test
