// powers.hpp - exponential, logarithm and powers, the same bits on every machine.
//
// The mathematical library picks its routines by the CPU, and nvcc has others; these are made of
// + - * / and of the bits of numbers alone. Errors are below 2 units in the last place of exp_of
// and log_of; that of pow_of(x, y) is about |y log x| times that.
#pragma once

#include <cstring>

#include "core/base/lanes.hpp"

namespace cdem {

/// The bits of a number, as an integer, and back.
CDEM_HD inline std::int64_t bits_of(Real number) {
  std::int64_t bits;
  std::memcpy(&bits, &number, sizeof bits);
  return bits;
}
CDEM_HD inline Real number_of(std::int64_t bits) {
  Real number;
  std::memcpy(&number, &bits, sizeof number);
  return number;
}
#if !defined(__CUDACC__)
inline Mask::Bits bits_of(Pack number) { return (Mask::Bits)number.n; }
inline Pack number_of(Mask::Bits bits) { return {(Pack::Numbers)bits}; }
#endif

namespace powers {
inline constexpr Real ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;
inline constexpr Real whole = 4503599627370496.0;  // 2^52: above it numbers are whole
inline constexpr std::int64_t fraction = 0x000fffffffffffff;
}  // namespace powers

/// e^x, for x between -700 and 700.
template <class T>
CDEM_HD inline T exp_of(const T& x) {
  using namespace powers;
  const T nearest(1.5 * whole);
  const T k = (x * T(1.44269504088896340736) + nearest) - nearest;
  const T high = x - k * T(ln2_high), low = k * T(ln2_low);
  const T r = high - low;
  T sum(1.0);  // 1 + r/13 (.. 1 + r/3 (1 + r/2))
  for (int n = 13; n > 1; --n) sum = T(1.0) + sum * r / T(n);
  const T scale = number_of((bits_of(k + T(whole + 1023)) & 0x7ff) << 52);
  return scale + scale * (sum * r + ((high - r) - low));
}

/// Natural logarithm of a number above 1e-300.
template <class T>
CDEM_HD inline T log_of(const T& x) {
  using namespace powers;
  const auto bits = bits_of(x);
  T k = number_of(((bits >> 52) & 0x7ff) | bits_of(T(whole))) - T(whole + 1023);
  T m = number_of((bits & fraction) | bits_of(T(1.0)));
  const auto large = m > T(1.41421356237309504880);
  m = select(large, T(0.5) * m, m);
  k = select(large, k + T(1.0), k);
  // log m = f - f^2/2 + s (f^2/2 + 2 s^2 (1/3 + s^2/5 + ..)), f = m - 1, s = f / (2 + f)
  const T f = m - T(1.0), s = f / (T(2.0) + f), z = s * s, half = T(0.5) * (f * f);
  T sum(0.0);
  for (int n = 23; n >= 3; n -= 2) sum = sum * z + T(2.0 / n);
  return k * T(ln2_high) - ((half - (s * (half + z * sum) + k * T(ln2_low))) - f);
}

/// x^y for x above 1e-300.
template <class T>
CDEM_HD inline T pow_of(const T& x, const T& y) {
  return exp_of(y * log_of(x));
}

}  // namespace cdem
