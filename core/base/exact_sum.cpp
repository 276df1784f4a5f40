// exact_sum.cpp - see exact_sum.hpp.
//
// Rounded to multiples of a unit, by adding and taking away a number whose last place has it,
// numbers add up in floating point without round-off, many at once in lanes. What this leaves is
// rounded to a finer unit, until nothing is left. Demmel & Nguyen (2013), Fast reproducible
// floating-point summation, has the rounding; Neal (2015), Fast exact summation using small and
// large superaccumulators, the digits.
#include "core/base/exact_sum.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace cdem {

namespace {

constexpr int digit_bits = ExactSum::digit_bits;
constexpr Index together = 4;  // packs, so that none waits for the one before

/// The unit of a digit is two to this power.
constexpr int exponent_of(int digit) { return digit_bits * digit + ExactSum::lowest; }

/// The lowest digit in which a number counts less than 2^31.
int digit_of(Real number) {
  const int exponent = std::ilogb(number) + 1;
  return std::max(0, (exponent - exponent_of(0)) / digit_bits);
}

Pack load(const Real* numbers) {
  Pack p;
  std::memcpy(&p.n, numbers, sizeof p.n);
  return p;
}
Pack size_of(const Pack& x) { return number_of(bits_of(x) & ~bits_of(Pack(-0.0))); }

/// One number of some packs.
template <class Combine>
Real reduce(const Pack (&packs)[together], const Combine& combine) {
  Real all = 0;
  for (const Pack& p : packs)
    for (Index j = 0; j < lanes; ++j) all = combine(all, p.n[j]);
  return all;
}
Real larger(Real a, Real b) { return a > b ? a : b; }

/// The largest size of some numbers; infinity if one of them is no finite number.
Real largest_of_all(const Real* numbers, Index count) {
  Pack largest[together]{0.0, 0.0, 0.0, 0.0}, nothing[together]{0.0, 0.0, 0.0, 0.0};
  for (Index i = 0; i < count; i += together * lanes)
    for (Index k = 0; k < together; ++k) {
      const Pack x = load(numbers + i + k * lanes);
      largest[k] = max_of(size_of(x), largest[k]);
      nothing[k] += Pack(0.0) * x;
    }
  const Real none = reduce(nothing, [](Real a, Real b) { return a + b; });
  return none == 0 ? reduce(largest, larger) : std::numeric_limits<Real>::infinity();
}

/// Take from every number its nearest multiple of a unit, and return the sum of these. `large` has
/// this unit in its last place. The largest remainder comes back in `largest`.
Real take(Real* numbers, Index count, Real large, Real& largest) {
  const Pack shift(large);
  Pack sum[together]{0.0, 0.0, 0.0, 0.0}, left[together]{0.0, 0.0, 0.0, 0.0};
  for (Index i = 0; i < count; i += together * lanes)
    for (Index k = 0; k < together; ++k) {
      Real* const at = numbers + i + k * lanes;
      const Pack x = load(at), whole = (x + shift) - shift, rest = x - whole;
      sum[k] += whole;
      left[k] = max_of(size_of(rest), left[k]);
      std::memcpy(at, &rest.n, sizeof rest.n);
    }
  largest = reduce(left, larger);
  return reduce(sum, [](Real a, Real b) { return a + b; });
}

}  // namespace

void ExactSum::add(Real* numbers, Index count) {
  while (count % (together * lanes) != 0) numbers[count++] = 0;
  Real largest = largest_of_all(numbers, count);
  if (!(largest < std::ldexp(1.0, too_large))) {
    ++word_[digits];
    return;
  }
  for (int digit = digits; largest > 0;) {
    digit = std::min(digit_of(largest), digit - 1);  // half a unit, which may be left, fits as well
    const int unit = exponent_of(digit);
    const Real sum = take(numbers, count, std::ldexp(1.5, unit + 52), largest);
    word_[digit] += std::int64_t(std::ldexp(sum, -unit));
  }
}

void ExactSum::add(const std::int64_t* part) {
  for (int k = 0; k < words; ++k) word_[k] += part[k];
}

Real ExactSum::value() const {
  if (word_[digits] > 0) return std::numeric_limits<Real>::quiet_NaN();
  Real sum = 0;
  std::int64_t carry = 0;
  for (int k = 0; k < digits; ++k) {
    std::int64_t here = word_[k] + carry;
    carry = 0;
    if (k + 1 < digits) {
      carry = (here + (std::int64_t(1) << (digit_bits - 1))) >> digit_bits;
      here -= carry << digit_bits;
    }
    if (here != 0) sum = std::ldexp(Real(here), exponent_of(k)) + sum;
  }
  return sum;
}

}  // namespace cdem
