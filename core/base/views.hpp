// views.hpp - the light views of columns that kernels read and write.
#pragma once

#include <cstddef>
#include <cstring>

#include "core/base/math.hpp"
#include "core/base/prefetch.hpp"

namespace cdem {

/// Read view of a table.
struct InTable {
  const Real* data;
  Index stride;
  CDEM_HD Real at(Index row, One item) const { return data[std::size_t(row) * stride + item.i]; }
  CDEM_HD void fetch(Index row, One item) const {
    cdem::fetch(data + std::size_t(row) * stride + item.i);
  }
#if !defined(__CUDACC__)
  Pack at(Index row, Lane item) const {
    Pack p;
    std::memcpy(&p.n, data + std::size_t(row) * stride + item.i, sizeof p.n);
    return p;
  }
#endif
};

/// Read and write view of a table.
struct InOutTable {
  Real* data;
  Index stride;
  CDEM_HD Real at(Index row, One item) const { return data[std::size_t(row) * stride + item.i]; }
  CDEM_HD void set(Index row, One item, Real value) const {
    data[std::size_t(row) * stride + item.i] = value;
  }
#if !defined(__CUDACC__)
  Pack at(Index row, Lane item) const {
    Pack p;
    std::memcpy(&p.n, data + std::size_t(row) * stride + item.i, sizeof p.n);
    return p;
  }
  void set(Index row, Lane item, Pack value) const {
    std::memcpy(data + std::size_t(row) * stride + item.i, &value.n, sizeof value.n);
  }
#endif
};

/// Read view of flags, one an item.
struct InFlags {
  const Flag* data;
  /// The items whose flag has this value.
  CDEM_HD bool equal(Flag value, One item) const { return data[item.i] == value; }
#if !defined(__CUDACC__)
  Mask equal(Flag value, Lane item) const {
    Flag __attribute__((vector_size(CDEM_LANES))) flags;
    std::memcpy(&flags, data + item.i, sizeof flags);
    return {__builtin_convertvector(flags == value, Mask::Bits)};
  }
#endif
};

/// Connectivity: index k of item i is data[k*stride + i].
struct InIndices {
  const Index* data;
  Index stride;
  CDEM_HD Index at(Index row, Index item) const { return data[std::size_t(row) * stride + item]; }
  CDEM_HD Index at(Index row, One item) const { return at(row, item.i); }
  CDEM_HD void fetch(Index row, One item) const {
    cdem::fetch(data + std::size_t(row) * stride + item.i);
  }
#if !defined(__CUDACC__)
  IndexPack at(Index row, Lane item) const {
    IndexPack p;
    std::memcpy(p.id, data + std::size_t(row) * stride + item.i, sizeof p.id);
    return p;
  }
  IndexPack at(Index row, const IndexPack& item) const {
    IndexPack p;
    for (Index j = 0; j < lanes; ++j) p.id[j] = at(row, item.id[j]);
    return p;
  }
#endif
};

/// Four numbers that lie together in a row.
template <class T>
struct Four {
  T x, y, z, w;
  CDEM_HD Vec3<T> vector() const { return {x, y, z}; }
};

#if !defined(__CUDACC__)
// Shuffles in registers turn rows of numbers into packs, and back: a pack that is put together in
// memory, number by number, stalls the processor when it is read.

/// The numbers at these places of two packs, one after the other.
template <int... places>
inline Pack::Numbers pick(const Pack::Numbers& a, const Pack::Numbers& b) {
#if defined(__clang__)
  return __builtin_shufflevector(a, b, places...);
#else
  return __builtin_shuffle(a, b, Mask::Bits{places...});
#endif
}

/// Rows of four numbers, one a lane at row(lane).
template <class Rows>
CDEM_HD inline Four<Pack> load_fours(const Rows& row) {
#if CDEM_LANES == 8
  Pack::Numbers r[4];
  for (Index j = 0; j < 4; ++j)
    r[j] = (Pack::Numbers)_mm512_maskz_insertf64x4(
        0xff, _mm512_castpd256_pd512(_mm256_loadu_pd(row(j))), _mm256_loadu_pd(row(4 + j)), 1);
  const auto xz01 = pick<0, 8, 2, 10, 4, 12, 6, 14>(r[0], r[1]);
  const auto xz23 = pick<0, 8, 2, 10, 4, 12, 6, 14>(r[2], r[3]);
  const auto y01 = pick<1, 9, 3, 11, 5, 13, 7, 15>(r[0], r[1]);
  const auto y23 = pick<1, 9, 3, 11, 5, 13, 7, 15>(r[2], r[3]);
  return {{pick<0, 1, 8, 9, 4, 5, 12, 13>(xz01, xz23)},
          {pick<0, 1, 8, 9, 4, 5, 12, 13>(y01, y23)},
          {pick<2, 3, 10, 11, 6, 7, 14, 15>(xz01, xz23)},
          {pick<2, 3, 10, 11, 6, 7, 14, 15>(y01, y23)}};
#elif CDEM_LANES == 4
  const auto r0 = Row::at(row(0)).n, r1 = Row::at(row(1)).n, r2 = Row::at(row(2)).n,
             r3 = Row::at(row(3)).n;
  const auto xz01 = pick<0, 4, 2, 6>(r0, r1), xz23 = pick<0, 4, 2, 6>(r2, r3);
  const auto y01 = pick<1, 5, 3, 7>(r0, r1), y23 = pick<1, 5, 3, 7>(r2, r3);
  return {{pick<0, 1, 4, 5>(xz01, xz23)},
          {pick<0, 1, 4, 5>(y01, y23)},
          {pick<2, 3, 6, 7>(xz01, xz23)},
          {pick<2, 3, 6, 7>(y01, y23)}};
#else
  return {pack_of([&](Index j) { return row(j)[0]; }), pack_of([&](Index j) { return row(j)[1]; }),
          pack_of([&](Index j) { return row(j)[2]; }), pack_of([&](Index j) { return row(j)[3]; })};
#endif
}
/// Their first three.
template <class Rows>
CDEM_HD inline Vec3<Pack> load_rows(const Rows& row) {
  const Four<Pack> r = load_fours(row);
  return {r.x, r.y, r.z};
}
/// The same back.
template <class Rows>
CDEM_HD inline void store_fours(const Four<Pack>& v, const Rows& row) {
#if CDEM_LANES == 8
  const auto xy02 = pick<0, 8, 2, 10, 4, 12, 6, 14>(v.x.n, v.y.n);
  const auto xy13 = pick<1, 9, 3, 11, 5, 13, 7, 15>(v.x.n, v.y.n);
  const auto zw02 = pick<0, 8, 2, 10, 4, 12, 6, 14>(v.z.n, v.w.n);
  const auto zw13 = pick<1, 9, 3, 11, 5, 13, 7, 15>(v.z.n, v.w.n);
  const Pack::Numbers r[4] = {
      pick<0, 1, 8, 9, 4, 5, 12, 13>(xy02, zw02), pick<0, 1, 8, 9, 4, 5, 12, 13>(xy13, zw13),
      pick<2, 3, 10, 11, 6, 7, 14, 15>(xy02, zw02), pick<2, 3, 10, 11, 6, 7, 14, 15>(xy13, zw13)};
  for (Index j = 0; j < 4; ++j) {
    _mm256_storeu_pd(row(j), _mm512_maskz_extractf64x4_pd(0xff, (__m512d)r[j], 0));
    _mm256_storeu_pd(row(4 + j), _mm512_maskz_extractf64x4_pd(0xff, (__m512d)r[j], 1));
  }
#elif CDEM_LANES == 4
  const auto xy02 = pick<0, 4, 2, 6>(v.x.n, v.y.n), xy13 = pick<1, 5, 3, 7>(v.x.n, v.y.n);
  const auto zw02 = pick<0, 4, 2, 6>(v.z.n, v.w.n), zw13 = pick<1, 5, 3, 7>(v.z.n, v.w.n);
  Row{pick<0, 1, 4, 5>(xy02, zw02)}.store(row(0));
  Row{pick<0, 1, 4, 5>(xy13, zw13)}.store(row(1));
  Row{pick<2, 3, 6, 7>(xy02, zw02)}.store(row(2));
  Row{pick<2, 3, 6, 7>(xy13, zw13)}.store(row(3));
#else
  for (Index j = 0; j < lanes; ++j) {
    Real* r = row(j);
    r[0] = v.x.n[j], r[1] = v.y.n[j], r[2] = v.z.n[j], r[3] = v.w.n[j];
  }
#endif
}
#endif

/// Four numbers that follow each other in a list, from a place on or from one a lane; and back.
CDEM_HD inline Four<Real> fours_at(const Real* list, Index place) {
  const Real* r = list + place;
  return {r[0], r[1], r[2], r[3]};
}
CDEM_HD inline void set_fours(Real* list, Index place, const Four<Real>& v) {
  Real* r = list + place;
  r[0] = v.x, r[1] = v.y, r[2] = v.z, r[3] = v.w;
}
#if !defined(__CUDACC__)
inline Four<Pack> fours_at(const Real* list, const IndexPack& place) {
  return load_fours([&](Index j) { return list + place.id[j]; });
}
inline void set_fours(Real* list, const IndexPack& place, const Four<Pack>& v) {
  store_fours(v, [&](Index j) { return list + place.id[j]; });
}
#endif

/// Rows of 8 numbers, read four at a time from place `from`, and written.
struct InRows {
  const Real* rows;
  CDEM_HD Four<Real> at(Index row, Index from) const {
    const Real* r = rows + std::size_t(row) * 8 + from;
    return {r[0], r[1], r[2], r[3]};
  }
  CDEM_HD Four<Real> at(One item, Index from) const { return at(item.i, from); }
  /// The same of `none` where there is no row (-1).
  CDEM_HD Four<Real> at(Index row, Index from, const Real* none) const {
    return row < 0 ? InRows{none}.at(0, from) : at(row, from);
  }
#if !defined(__CUDACC__)
  Four<Pack> at(const IndexPack& row, Index from) const {
    return load_fours([&](Index j) { return rows + std::size_t(row.id[j]) * 8 + from; });
  }
  Four<Pack> at(const IndexPack& row, Index from, const Real* none) const {
    const Real* of[lanes];
    for (Index j = 0; j < lanes; ++j)
      of[j] = (row.id[j] < 0 ? none : rows + std::size_t(row.id[j]) * 8) + from;
    return load_fours([&](Index j) { return of[j]; });
  }
  Four<Pack> at(Lane item, Index from) const {
    return load_fours([&](Index j) { return rows + std::size_t(item.i + j) * 8 + from; });
  }
#endif
};

/// Write a flag for every item.
CDEM_HD inline void set_flags(Flag* flags, One item, bool mask) { flags[item.i] = mask ? 1 : 0; }
#if !defined(__CUDACC__)
inline void set_flags(Flag* flags, Lane item, Mask mask) {
  for (Index j = 0; j < lanes; ++j) flags[item.i + j] = mask.bits[j] ? 1 : 0;
}
#endif

/// Write one row of 8 numbers for every item.
CDEM_HD inline void set_rows(Real* rows, Index item, const Real* numbers) {
  for (Index k = 0; k < 8; ++k) rows[std::size_t(item) * 8 + k] = numbers[k];
}
CDEM_HD inline void set_rows(Real* rows, One item, const Real* numbers) {
  set_rows(rows, item.i, numbers);
}
#if !defined(__CUDACC__)
inline void set_rows(Real* rows, const IndexPack& item, const Pack* n) {
  const auto row = [&](Index j) { return rows + std::size_t(item.id[j]) * 8; };
  store_fours({n[0], n[1], n[2], n[3]}, row);
  store_fours({n[4], n[5], n[6], n[7]}, [&](Index j) { return row(j) + 4; });
}
inline void set_rows(Real* rows, Lane item, const Pack* n) {
  IndexPack places;
  for (Index j = 0; j < lanes; ++j) places.id[j] = item.i + j;
  set_rows(rows, places, n);
}
#endif

/// Numbers or indices of a list, looked up for an index or for one a lane; numbers added to it.
template <class Ids>
CDEM_HD inline auto look_up(const Real* list, const Ids& place) {
  return numbers_of([&](Index i) { return list[i]; }, place);
}
template <class Ids>
CDEM_HD inline auto look_up(const Index* list, const Ids& place) {
  return indices_of([&](Index i) { return list[i]; }, place);
}
/// Write the number of an item.
CDEM_HD inline void store(Real* list, One item, Real number) { list[item.i] = number; }
#if !defined(__CUDACC__)
inline void store(Real* list, Lane item, Pack number) {
  std::memcpy(list + item.i, &number.n, sizeof number.n);
}
#endif
CDEM_HD inline void add_to(Real* list, Index place, Real number) { list[place] += number; }
#if !defined(__CUDACC__)
inline void add_to(Real* list, const IndexPack& place, Pack number) {
  for (Index j = 0; j < lanes; ++j) list[place.id[j]] += number.n[j];
}
#endif

/// Motion of the nodes, one 64-byte row each: position x y z, pad, velocity x y z, pad.
struct InMotion {
  const Real* rows;
  CDEM_HD Vec3<Real> position(Index node) const {
    const Real* r = rows + std::size_t(node) * 8;
    return {r[0], r[1], r[2]};
  }
  CDEM_HD Vec3<Real> velocity(Index node) const {
    const Real* r = rows + std::size_t(node) * 8 + 4;
    return {r[0], r[1], r[2]};
  }
  CDEM_HD Row velocity_row(Index node) const { return Row::at(rows + std::size_t(node) * 8 + 4); }
  CDEM_HD void fetch(Index node) const { cdem::fetch(rows + std::size_t(node) * 8); }
#if !defined(__CUDACC__)
  Vec3<Pack> position(const IndexPack& node) const { return gather(node, 0); }
  Vec3<Pack> velocity(const IndexPack& node) const { return gather(node, 4); }

 private:
  Vec3<Pack> gather(const IndexPack& node, int from) const {
    return load_rows([&](Index j) { return rows + std::size_t(node.id[j]) * 8 + from; });
  }
#endif
};

/// Forces on corners, one 32-byte row each: x y z, pad. Gathered by nodes in a fixed order.
struct OutForces {
  Real* rows;
  CDEM_HD void set(One item, Index corners_per_item, Index corner, const Vec3<Real>& f) const {
    Real* r = rows + (std::size_t(item.i) * corners_per_item + corner) * 4;
    r[0] = f.x;
    r[1] = f.y;
    r[2] = f.z;
    r[3] = 0;
  }
  CDEM_HD void add(One item, Index corners_per_item, Index corner, const Vec3<Real>& f) const {
    const Real* r = rows + (std::size_t(item.i) * corners_per_item + corner) * 4;
    set(item, corners_per_item, corner, Row::at(r).vector() + f);
  }
#if !defined(__CUDACC__)
  void add(Lane item, Index corners_per_item, Index corner, const Vec3<Pack>& f) const {
    const auto row = [&](Index j) {
      return rows + (std::size_t(item.i + j) * corners_per_item + corner) * 4;
    };
    set(item, corners_per_item, corner, load_rows(row) + f);
  }
  void set(Lane item, Index corners_per_item, Index corner, const Vec3<Pack>& f) const {
    store_fours({f.x, f.y, f.z, Pack(0.0)}, [&](Index j) {
      return rows + (std::size_t(item.i + j) * corners_per_item + corner) * 4;
    });
  }
#endif
};

struct InForces {
  const Real* rows;
  CDEM_HD Row at(std::size_t row) const { return Row::at(rows + row * 4); }
  /// Row `row`, or for ~row the negative of that row. No branch: the processor could not
  /// predict it.
  CDEM_HD Row signed_row(Index row) const { return Real(2 * (row >> 31) + 1) * at(plain(row)); }
  CDEM_HD Vec3<Real> signed_at(Index row) const { return signed_row(row).vector(); }
#if !defined(__CUDACC__)
  Vec3<Pack> signed_at(const IndexPack& row) const {
    Index __attribute__((vector_size(4 * CDEM_LANES))) opposite;
    std::memcpy(&opposite, row.id, sizeof opposite);
    opposite >>= 31;
    const Pack sign = __builtin_convertvector(2 * opposite + 1, Pack::Numbers);
    return sign * load_rows([&](Index j) { return rows + plain(row.id[j]) * 4; });
  }
#endif
  CDEM_HD void fetch_signed(Index row) const { fetch(rows + plain(row) * 4); }

 private:
  CDEM_HD static std::size_t plain(Index row) { return std::size_t(row ^ (row >> 31)); }
};

}  // namespace cdem
