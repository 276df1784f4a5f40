// lanes.hpp - items of a kernel (One, Lane) and the packs of numbers that it computes with.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#if defined(__AVX__)
#include <immintrin.h>
#endif
#if defined(__CUDACC__)
#include <cuda_runtime.h>
#define CDEM_HD __host__ __device__
#define CDEM_OUT_OF_LINE __host__ __device__ __noinline__
#else
// Kernels are small functions over packs of numbers; one that is called and not inlined takes its
// packs through memory.
#define CDEM_HD __attribute__((always_inline))
// Code for rare items, of which many kernels would else have a copy.
#define CDEM_OUT_OF_LINE __attribute__((noinline))
#endif

namespace cdem {

using Real = double;
using Index = std::int32_t;
using Flag = std::int8_t;
inline constexpr Real infinity = std::numeric_limits<Real>::infinity();

#if !defined(CDEM_LANES)
#define CDEM_LANES 4
#endif

/// Items that one SIMD register holds. The build sets it to match the instruction set: 2, 4 or 8.
inline constexpr Index lanes = CDEM_LANES;

/// Item of a kernel that runs for one number at a time.
struct One {
  Index i;
};

CDEM_HD inline Real select(bool mask, Real yes, Real no) { return mask ? yes : no; }
CDEM_HD inline Real max_of(Real a, Real b) { return a > b ? a : b; }
CDEM_HD inline Real min_of(Real a, Real b) { return a < b ? a : b; }
CDEM_HD inline Real abs_of(Real a) { return a < 0 ? -a : a; }
CDEM_HD inline Real sqrt_of(Real a) { return std::sqrt(a); }
CDEM_HD inline unsigned lane_bits(bool mask) { return mask; }
CDEM_HD inline bool any_of(bool mask) { return mask; }

/// The bits of a number as an integer, and back.
CDEM_HD inline std::int64_t bits_of(Real a) { return __builtin_bit_cast(std::int64_t, a); }
CDEM_HD inline Real number_of(std::int64_t bits) { return __builtin_bit_cast(Real, bits); }

/// Item of a kernel that selects its items: an item of a row.
struct Selected {
  Index row, id;
};

/// Items of a row: from `first` to before `last`.
struct Range {
  Index first, last;
};

#if !defined(__CUDACC__)

/// Item of a kernel that runs for `lanes` consecutive numbers at once.
struct Lane {
  Index i;
};

/// Outcome of a comparison, lane by lane: all bits set for true.
struct Mask {
  using Bits = std::int64_t __attribute__((vector_size(8 * CDEM_LANES)));
  Bits bits;
  friend Mask operator&(Mask a, Mask b) { return {a.bits & b.bits}; }
  friend Mask operator|(Mask a, Mask b) { return {a.bits | b.bits}; }
  friend Mask operator!(Mask a) { return {~a.bits}; }
};

/// One number per lane. Arithmetic is as for Real, lane by lane, so results do not depend on it.
struct Pack {
  using Numbers = Real __attribute__((vector_size(8 * CDEM_LANES)));
  Numbers n;

  Pack() = default;
  Pack(Numbers numbers) : n(numbers) {}
  Pack(Real number) : n(number - Numbers{}) {}

  friend Pack operator+(Pack a, Pack b) { return {a.n + b.n}; }
  friend Pack operator-(Pack a, Pack b) { return {a.n - b.n}; }
  friend Pack operator*(Pack a, Pack b) { return {a.n * b.n}; }
  friend Pack operator/(Pack a, Pack b) { return {a.n / b.n}; }
  friend Pack operator-(Pack a) { return {-a.n}; }
  friend Mask operator<(Pack a, Pack b) { return {a.n < b.n}; }
  friend Mask operator>(Pack a, Pack b) { return {a.n > b.n}; }
  Pack& operator+=(Pack b) { return *this = *this + b; }
  Pack& operator-=(Pack b) { return *this = *this - b; }
};

inline Pack select(Mask mask, Pack yes, Pack no) { return {mask.bits ? yes.n : no.n}; }
inline Pack max_of(Pack a, Pack b) { return select(a > b, a, b); }
inline Pack min_of(Pack a, Pack b) { return select(a < b, a, b); }
inline Pack abs_of(Pack a) { return select(a < Pack(0.0), -a, a); }
inline Pack sqrt_of(Pack a) {
  Pack root;
  for (Index j = 0; j < lanes; ++j) root.n[j] = std::sqrt(a.n[j]);
  return root;
}
/// The lanes for which a comparison holds, as bits.
inline unsigned lane_bits(Mask mask) {
#if CDEM_LANES == 8
  return _mm512_movepi64_mask((__m512i)mask.bits);
#elif CDEM_LANES == 4
  return unsigned(_mm256_movemask_pd((__m256d)mask.bits));
#else
  unsigned bits = 0;
  for (Index j = 0; j < lanes; ++j) bits |= unsigned(mask.bits[j] & 1) << j;
  return bits;
#endif
}
inline bool any_of(Mask mask) { return lane_bits(mask) != 0; }
inline Mask::Bits bits_of(Pack a) { return (Mask::Bits)a.n; }
inline Pack number_of(Mask::Bits bits) { return {(Pack::Numbers)bits}; }

/// A pack of the results of `number` for each lane.
template <class Of, Index... lane>
CDEM_HD inline Pack pack_of(const Of& number, std::integer_sequence<Index, lane...>) {
  return {Pack::Numbers{number(lane)...}};
}
template <class Of>
CDEM_HD inline Pack pack_of(const Of& number) {
  return pack_of(number, std::make_integer_sequence<Index, lanes>{});
}

/// One index per lane, as read from a connectivity table.
struct IndexPack {
  Index id[CDEM_LANES];
};

/// As many selected items as there are lanes, whatever rows they are of.
struct SelectedLane {
  IndexPack row, id;
};

#endif

/// The number type that a kernel computes with for a type of items or indices: Real for One, Pack
/// for Lane.
template <class Item>
struct NumberOf {
  using type = Real;
};
#if !defined(__CUDACC__)
template <>
struct NumberOf<Lane> {
  using type = Pack;
};
template <>
struct NumberOf<SelectedLane> {
  using type = Pack;
};
template <>
struct NumberOf<IndexPack> {
  using type = Pack;
};
#endif
template <class Item>
using Number = typename NumberOf<Item>::type;

/// The index type of a kernel for an item type: Index for One, IndexPack for Lane.
template <class Item>
struct IndexOf {
  using type = Index;
};

#if !defined(__CUDACC__)
template <>
struct IndexOf<Lane> {
  using type = IndexPack;
};
template <>
struct IndexOf<SelectedLane> {
  using type = IndexPack;
};
#endif

/// Result of comparisons of a number type: bool, Mask.
template <class T>
using Truth = decltype(T() < T());

/// Does a comparison hold for a lane?
CDEM_HD inline bool holds(bool outcome, Index) { return outcome; }
/// The number of a lane.
CDEM_HD inline Real of_lane(Real number, Index) { return number; }
/// The index of a lane.
CDEM_HD inline Index& of_lane(Index& index, Index) { return index; }
CDEM_HD inline Index of_lane(const Index& index, Index) { return index; }
/// Do something for every lane of a selected item, with the number of the lane, row and item.
template <class Do>
CDEM_HD inline void for_lanes(const Selected& item, const Do& act) {
  act(0, item.row, item.id);
}
/// The same for every lane of an item, with the number of the lane and the item.
template <class Do>
CDEM_HD inline void for_lanes(One item, const Do& act) {
  act(0, item.i);
}
template <class Do>
CDEM_HD inline void for_lanes(Index item, const Do& act) {
  act(0, item);
}
#if !defined(__CUDACC__)
CDEM_HD inline bool holds(const Mask& outcome, Index lane) { return outcome.bits[lane] != 0; }
CDEM_HD inline Index& of_lane(IndexPack& index, Index lane) { return index.id[lane]; }
CDEM_HD inline Index of_lane(const IndexPack& index, Index lane) { return index.id[lane]; }
CDEM_HD inline Real of_lane(const Pack& number, Index lane) { return number.n[lane]; }
template <class Do>
CDEM_HD inline void for_lanes(const IndexPack& item, const Do& act) {
  for (Index j = 0; j < lanes; ++j) act(j, item.id[j]);
}
template <class Do>
CDEM_HD inline void for_lanes(const SelectedLane& item, const Do& act) {
  for (Index j = 0; j < lanes; ++j) act(j, item.row.id[j], item.id.id[j]);
}
template <class Do>
CDEM_HD inline void for_lanes(Lane item, const Do& act) {
  for (Index j = 0; j < lanes; ++j) act(j, item.i + j);
}
#endif

/// Indices made of indices, lane by lane.
template <class Of, class... Rest>
CDEM_HD inline Index indices_of(const Of& of, Index first, Rest... rest) {
  return of(first, rest...);
}
template <class Of>
CDEM_HD inline Index indices_of(const Of& of, One item) {
  return of(item.i);
}
/// Numbers made of indices, lane by lane.
template <class Of, class... Rest>
CDEM_HD inline Real numbers_of(const Of& of, Index first, Rest... rest) {
  return of(first, rest...);
}
CDEM_HD inline bool differ(Index a, Index b) { return a != b; }
CDEM_HD inline bool is_less(Index a, Index b) { return a < b; }
CDEM_HD inline bool has_bit(Index bits, Index bit) { return bits >> bit & 1; }
/// Is it no place or number, which is -1?
CDEM_HD inline bool is_none(Index a) { return a < 0; }
#if !defined(__CUDACC__)
template <class Of, class... Rest>
CDEM_HD inline IndexPack indices_of(const Of& of, const IndexPack& first, const Rest&... rest) {
  IndexPack pack;
  for (Index j = 0; j < lanes; ++j) pack.id[j] = of(first.id[j], rest.id[j]...);
  return pack;
}
template <class Of>
CDEM_HD inline IndexPack indices_of(const Of& of, Lane item) {
  IndexPack pack;
  for (Index j = 0; j < lanes; ++j) pack.id[j] = of(item.i + j);
  return pack;
}
template <class Of, class... Rest>
CDEM_HD inline Pack numbers_of(const Of& of, const IndexPack& first, const Rest&... rest) {
  return pack_of([&](Index j) { return Real(of(first.id[j], rest.id[j]...)); });
}
/// Indices in one register, and its 1 or 0 per lane as a comparison.
using Indices = Index __attribute__((vector_size(4 * CDEM_LANES)));
CDEM_HD inline Indices in_register(const IndexPack& pack) {
  Indices a;
  std::memcpy(&a, pack.id, sizeof a);
  return a;
}
CDEM_HD inline Mask mask_of(Indices ones) { return {-__builtin_convertvector(ones, Mask::Bits)}; }
CDEM_HD inline Mask is_less(const IndexPack& a, const IndexPack& b) {
  return mask_of(-(in_register(a) < in_register(b)));
}
CDEM_HD inline Mask has_bit(const IndexPack& bits, Index bit) {
  return mask_of(in_register(bits) >> bit & 1);
}
CDEM_HD inline Mask is_none(const IndexPack& a) { return has_bit(a, 31); }
CDEM_HD inline Mask differ(const IndexPack& a, const IndexPack& b) {
  Mask mask;
  for (Index j = 0; j < lanes; ++j) mask.bits[j] = -std::int64_t(a.id[j] != b.id[j]);
  return mask;
}
#endif

}  // namespace cdem
