// elementary.hpp - exponential function, logarithm, power and tangent. Those of the C library
// differ from CPU to CPU and from compiler to compiler; these have the same bits everywhere.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// Whole numbers lie in the lowest bits of their sum with this one: 1.5 * 2^52.
inline constexpr Real whole_number_base = 6755399441055744.0;
/// ln 2 in two parts, the first with zeros at its end so that whole multiples of it are exact.
inline constexpr Real ln2_high = 0x1.62e42feep-1, ln2_low = 0x1.a39ef35793c76p-33;

/// Sum of c[k] x^k.
template <std::size_t count, class T>
CDEM_HD inline T polynomial(const Real (&c)[count], const T& x) {
  T sum(c[count - 1]);
  for (std::size_t k = count - 1; k-- > 0;) sum = sum * x + T(c[k]);
  return sum;
}

/// e^x, with an error below 2 units in the last place. Beyond -700 and 700 it is the value at the
/// limit.
template <class T>
CDEM_HD inline T exp_of(const T& number) {
  constexpr Real factorials[] = {1.0,
                                 1.0,
                                 1.0 / 2,
                                 1.0 / 6,
                                 1.0 / 24,
                                 1.0 / 120,
                                 1.0 / 720,
                                 1.0 / 5040,
                                 1.0 / 40320,
                                 1.0 / 362880,
                                 1.0 / 3628800,
                                 1.0 / 39916800,
                                 1.0 / 479001600,
                                 1.0 / 6227020800};
  const T x = min_of(max_of(number, T(-700.0)), T(700.0));
  const T shifted = x * T(1 / (ln2_high + ln2_low)) + T(whole_number_base);
  const T n = shifted - T(whole_number_base);  // x / ln 2, rounded
  const T rest = (x - n * T(ln2_high)) - n * T(ln2_low);
  const T two_to_n = number_of((bits_of(shifted) << 52) + bits_of(T(1.0)));
  return polynomial(factorials, rest) * two_to_n;
}

/// Natural logarithm of a number above 1e-300, with an error below 2 units in the last place, or
/// where it is near 0 below 1e-16.
template <class T>
CDEM_HD inline T log_of(const T& number) {
  constexpr Real odd[] = {2.0,      2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9, 2.0 / 11,
                          2.0 / 13, 2.0 / 15, 2.0 / 17, 2.0 / 19, 2.0 / 21};
  const T one(1.0), x = max_of(number, T(1e-300));
  // x = m 2^n with m from 1/sqrt(2) to sqrt(2)
  const auto bits = bits_of(x), half = bits_of(T(0.70710678118654752));
  const auto shift = (bits - half) >> 52;  // n
  const T m = number_of(bits - (shift << 52));
  const T n = number_of(shift + bits_of(T(whole_number_base))) - T(whole_number_base);
  const T s = (m - one) / (m + one);
  return n * T(ln2_high) + (s * polynomial(odd, s * s) + n * T(ln2_low));
}

/// x^y for x > 0.
template <class T>
CDEM_HD inline T pow_of(const T& x, const T& y) {
  return exp_of(y * log_of(x));
}

/// Tangent of an angle from 0 to 1.3 rad, with an error below 16 units in the last place: from that
/// of a quarter of it.
template <class T>
CDEM_HD inline T tan_of(const T& angle) {
  constexpr Real odd[] = {1.0,
                          1.0 / 3,
                          2.0 / 15,
                          17.0 / 315,
                          62.0 / 2835,
                          1382.0 / 155925,
                          21844.0 / 6081075,
                          929569.0 / 638512875,
                          6404582.0 / 10854718875,
                          443861162.0 / 1856156927625,
                          18888466084.0 / 194896477400625,
                          113927491862.0 / 2900518163668125};
  const T one(1.0), two(2.0), x = T(0.25) * angle;
  const T quarter = x * polynomial(odd, x * x);
  const T half = two * quarter / (one - quarter * quarter);
  return two * half / (one - half * half);
}

}  // namespace cdem
