// Sums that no order changes, and that lose nothing.
#include <omp.h>

#include <limits>
#include <numeric>
#include <vector>

#include "core/base/exact_sum.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

Real sum_of(const std::vector<Real>& numbers) {
  return exact_sum(Index(numbers.size()), [&](Index i) { return numbers[i]; });
}

}  // namespace

TEST_CASE("a sum has the same bits in any order, in any parts, on any number of threads") {
  Random random(1);
  std::vector<Real> numbers;
  for (Index i = 0; i < 5000; ++i)
    numbers.push_back(random.between(-1, 1) * std::pow(10.0, i % 37 - 18));
  const int threads = omp_get_max_threads();
  for (const Index count : {0, 1, 1023, 1024, 1025, 2048, 5000}) {
    std::vector<Real> some(numbers.begin(), numbers.begin() + count);
    omp_set_num_threads(1);
    const Real first = sum_of(some);
    for (const int on : {1, 2, 3, 7}) {
      omp_set_num_threads(on);
      std::reverse(some.begin(), some.begin() + count / 3 * 2);
      std::rotate(some.begin(), some.begin() + count / 5, some.end());
      CHECK(same_bits(sum_of(some), first));
    }
  }
  omp_set_num_threads(threads);
}

TEST_CASE("nothing is lost, however large what cancels") {
  CHECK(sum_of({1e100, 1, -1e100}) == 1);
  CHECK(sum_of({1e250, 1e-250, 3, -1e250, -3}) == 1e-250);
  CHECK(sum_of({0x1p972, -0x1p972, 0x1p-1074}) == 0x1p-1074);
  CHECK(sum_of({0x1p52, 0.5, 0.25, -0x1p52}) == 0.75);
  std::vector<Real> numbers(3000, 0.1);
  for (Index i = 0; i < 3000; ++i) numbers.push_back(-0.1);
  CHECK(sum_of(numbers) == 0);
}

TEST_CASE("sums are those of integers, and of long numbers within two units in the last place") {
  for (const Index count : {0, 1, 1023, 1024, 1025, 5000})
    CHECK(exact_sum(count, [](Index i) { return Real(i); }) == 0.5 * count * (count - 1.0));
  Random random(2);
  for (int round = 0; round < 50; ++round) {
    std::vector<Real> numbers;
    const Real scale = std::pow(10.0, random.between(-250, 250));
    for (Index i = random.below(3000); i >= 0; --i) numbers.push_back(scale * random.between(0, 1));
    const long double expected = std::accumulate(numbers.begin(), numbers.end(), 0.0L);
    CHECK(relative_error(sum_of(numbers), Real(expected)) < 5e-16);
  }
}

TEST_CASE("the smallest numbers count, what is none or too large makes the sum none") {
  std::vector<Real> smallest(2000, std::numeric_limits<Real>::denorm_min());
  CHECK(sum_of(smallest) == 2000 * std::numeric_limits<Real>::denorm_min());
  for (const Real bad :
       {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity(), -0x1p973}) {
    smallest[1500] = bad;
    CHECK(std::isnan(sum_of(smallest)));
  }
}

TEST_CASE("terms are made once, and columns are summed") {
  std::vector<Index> made(3000);
  exact_sum(3000, [&](Index i) { return Real(++made[i]); });
  CHECK(std::count(made.begin(), made.end(), 1) == 3000);
  Column<Real> ones;
  ones.resize(3000, 1.0);
  CHECK(column_sum(ones) == 3000);
}

}  // namespace cdem::test
