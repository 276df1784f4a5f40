// short_numbers.hpp - bounds in 16 bits, rounded to the side that a test allows.
#pragma once

#include <cfloat>

#include "core/base/lanes.hpp"

namespace cdem {

/// The upper half of a number in single precision: its sign, its exponent and 7 bits of its
/// mantissa.
using Short = std::uint16_t;

/// The least number of those that a `Short` holds which is not below another one: up to 1/128 more.
/// What is nearer to zero than single precision has normal numbers goes to the next of them.
template <class T>
CDEM_HD inline T round_up(const T& number) {
  constexpr std::int64_t last = std::int64_t(1) << 45;  // the last bit that is kept
  constexpr Real smallest = FLT_MIN;
  const T least(smallest), zero(0.0);
  const T small = select(number > zero, least, zero);
  const T normal = select(abs_of(number) < least, small, number);
  const T cut = number_of(bits_of(normal) & -last);
  return select(cut < normal, number_of(bits_of(cut) + last), cut);
}
/// The largest one that is not above it.
template <class T>
CDEM_HD inline T round_down(const T& number) {
  return -round_up(-number);
}

/// Write a number that a `Short` holds.
CDEM_HD inline void store(Short* list, One item, Real number) {
  list[item.i] = Short(__builtin_bit_cast(std::uint32_t, float(number)) >> 16);
}
#if !defined(__CUDACC__)
inline void store(Short* list, Lane item, Pack number) {
  using Bits = std::uint32_t __attribute__((vector_size(4 * CDEM_LANES)));
  using Numbers = float __attribute__((vector_size(4 * CDEM_LANES)));
  using Halves = Short __attribute__((vector_size(2 * CDEM_LANES)));
  const Bits bits = (Bits) __builtin_convertvector(number.n, Numbers) >> 16;
  const Halves halves = __builtin_convertvector(bits, Halves);
  std::memcpy(list + item.i, &halves, sizeof halves);
}
#endif

/// Read view of a table of them.
struct InBounds {
  const Short* data;
  Index stride;
  CDEM_HD Real at(Index row, One item) const {
    const std::uint32_t bits = std::uint32_t(data[std::size_t(row) * stride + item.i]) << 16;
    return Real(__builtin_bit_cast(float, bits));
  }
#if !defined(__CUDACC__)
  Pack at(Index row, Lane item) const {
    using Bits = std::uint32_t __attribute__((vector_size(4 * CDEM_LANES)));
    using Numbers = float __attribute__((vector_size(4 * CDEM_LANES)));
    Short __attribute__((vector_size(2 * CDEM_LANES))) halves;
    std::memcpy(&halves, data + std::size_t(row) * stride + item.i, sizeof halves);
    const Bits bits = __builtin_convertvector(halves, Bits) << 16;
    return {__builtin_convertvector((Numbers)bits, Pack::Numbers)};
  }
#endif
};

}  // namespace cdem
