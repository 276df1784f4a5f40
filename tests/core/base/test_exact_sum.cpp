// Sums that no order changes, and that lose nothing.
#include <limits>
#include <numeric>
#include <vector>

#include "core/base/exact_sum.hpp"
#include "core/base/openmp.hpp"
#include "core/base/primitive_loops.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// Its own number of each item.
struct OwnNumber {
  CDEM_HD Real operator()(One item) const { return item.i; }
};
/// How often a term was made.
struct TimesMade {
  Index* made;
  CDEM_HD Real operator()(One item) const { return Real(++made[item.i]); }
};

Real sum_of(const std::vector<Real>& numbers) {
  Column<Real> given;
  given.assign(numbers);
  return column_sum({}, given, {});
}

/// The same by the class that the CPU uses, whatever the device.
Real sum_in_parts(const std::vector<Real>& numbers) {
  ExactSum sum;
  Real part[ExactSum::most];
  for (std::size_t first = 0; first < numbers.size(); first += ExactSum::most) {
    const std::size_t count = std::min(numbers.size() - first, std::size_t(ExactSum::most));
    std::copy_n(numbers.begin() + first, count, part);
    sum.add(part, Index(count));
  }
  return sum.value();
}

/// The same by the digits of each number, as devices do.
Real sum_of_digits(const std::vector<Real>& numbers) {
  std::int64_t words[ExactSum::words] = {};
  for (const Real number : numbers) NumberDigits(number).add_to(words);
  ExactSum sum;
  sum.add(words);
  return sum.value();
}

/// A number with any bits, of an exponent below one of those.
Real any_number(Random& random, Index exponents) {
  const std::int64_t fraction = std::int64_t(random.between(0, 1) * 0x1p52);
  const std::int64_t exponent = random.below(exponents);
  const Real size = number_of(exponent << 52 | fraction);
  return random.below(2) == 0 ? size : -size;
}

/// Do all ways to sum some numbers give the same bits, on any number of threads?
bool all_agree(const std::vector<Real>& numbers) {
  const int before = omp_get_max_threads();
  const Real expected = sum_in_parts(numbers);
  bool same = same_bits(sum_of_digits(numbers), expected);
  for (int threads = 1; threads <= 7; ++threads) {
    omp_set_num_threads(threads);
    same = same && same_bits(sum_of(numbers), expected);
  }
  omp_set_num_threads(before);
  return same;
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
    CHECK(exact_sum({}, count, OwnNumber{}, {}) == 0.5 * count * (count - 1.0));
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

TEST_CASE("devices have the bits of the CPU, for numbers of any exponent and what cancels") {
  constexpr Index all = 1023 + ExactSum::too_large;  // exponents, those of the smallest numbers too
  Random random(3);
  for (const Index exponents : {1, 3, 60, 1000, all}) {
    for (const Index count : {1, 31, 33, 255, 257, 1025, random.below(40000)}) {
      CAPTURE(exponents);
      CAPTURE(count);
      std::vector<Real> numbers(count);
      for (Real& number : numbers) number = any_number(random, exponents);
      CHECK(all_agree(numbers));
      for (Index i = 0; i + 1 < count; i += 3) numbers[i + 1] = -numbers[i];
      for (Index i = 0; i < count; i += 7) numbers[i] = 0;
      CHECK(all_agree(numbers));
    }
  }
  // around the ends of a digit, and the largest
  std::vector<Real> ends;
  for (int exponent = -1074; exponent < ExactSum::too_large; ++exponent)
    for (const Real factor : {1.0, 1 + 0x1p-52, 2 - 0x1p-52, -1.5}) {
      ends.push_back(std::ldexp(factor, exponent));
      CHECK(same_bits(sum_of_digits({ends.back()}), sum_in_parts({ends.back()})));
    }
  CHECK(all_agree(ends));
}

TEST_CASE("a number that is none or too large is one wherever it stands") {
  Random random(4);
  for (const Real bad :
       {std::numeric_limits<Real>::quiet_NaN(), -std::numeric_limits<Real>::infinity(), 0x1p973})
    for (const Index place : {0, 31, 300, 4999}) {
      std::vector<Real> numbers(5000);
      for (Real& number : numbers) number = random.between(-1, 1);
      numbers[place] = bad;
      numbers[4998] = -bad;
      CHECK(std::isnan(sum_of(numbers)));
      CHECK(std::isnan(sum_of_digits(numbers)));
    }
}

TEST_CASE("terms are made once, and items of an array may lie apart") {
  Column<Index> made;
  made.resize(3000);
  CHECK(exact_sum({}, 3000, TimesMade{made.data()}, {}) == 3000);
  const std::vector<Index> times = fetch(made);
  CHECK(std::count(times.begin(), times.end(), 1) == 3000);
  std::vector<Real> numbers(4000, 1000);
  for (Index i = 1; i < 4000; i += 4) numbers[i] = 1;
  Column<Real> rows;
  rows.assign(numbers);
  CHECK(exact_sum({}, 1000, EachNumber<4>{rows.data() + 1}, {}) == 1000);
}

}  // namespace cdem::test
