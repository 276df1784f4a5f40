// math.hpp - small vectors and matrices over a number or a pack of numbers.
#pragma once

#include <cstring>

#include "core/base/lanes.hpp"

namespace cdem {

template <class T>
struct Vec3 {
  T x, y, z;
};

template <class T>
CDEM_HD inline Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
CDEM_HD inline Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
CDEM_HD inline Vec3<T> operator-(const Vec3<T>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class T>
CDEM_HD inline Vec3<T> operator*(const T& s, const Vec3<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
CDEM_HD inline T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
CDEM_HD inline Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class M, class T>
CDEM_HD inline Vec3<T> select(const M& mask, const Vec3<T>& yes, const Vec3<T>& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
template <class T>
CDEM_HD inline T norm(const Vec3<T>& a) {
  return sqrt_of(dot(a, a));
}
template <class T>
CDEM_HD inline Vec3<T> unit(const Vec3<T>& a) {
  return (T(1.0) / norm(a)) * a;
}

/// Four numbers that lie together in memory: x y z and one more. The arithmetic is as for Real,
/// number by number, in one register where there is one.
struct Row {
#if defined(CDEM_CUDA)
  struct Numbers {
    Real n[4];
    CDEM_HD Real& operator[](int k) { return n[k]; }
    CDEM_HD Real operator[](int k) const { return n[k]; }
  };
#else
  using Numbers = Real __attribute__((vector_size(32)));
#endif
  Numbers n;

  CDEM_HD static Row of(Real x, Real y, Real z) { return {Numbers{x, y, z, 0.0}}; }
  CDEM_HD static Row zero() { return of(0.0, 0.0, 0.0); }
  /// Rows begin at a multiple of 16 bytes.
  CDEM_HD static Row at(const Real* memory) {
#if defined(__CUDA_ARCH__)
    const double2* halves = reinterpret_cast<const double2*>(memory);
    const double2 a = halves[0], b = halves[1];
    return {Numbers{a.x, a.y, b.x, b.y}};
#else
    Row r;
    std::memcpy(&r.n, memory, sizeof r.n);
    return r;
#endif
  }
  CDEM_HD void store(Real* memory) const {
#if defined(__CUDA_ARCH__)
    double2* halves = reinterpret_cast<double2*>(memory);
    halves[0] = {n[0], n[1]};
    halves[1] = {n[2], n[3]};
#else
    std::memcpy(memory, &n, sizeof n);
#endif
  }
  CDEM_HD Vec3<Real> vector() const { return {n[0], n[1], n[2]}; }
  /// The same without the sign of the fourth.
  CDEM_HD Row with_size_of_last() const {
#if defined(CDEM_CUDA)
    return {Numbers{n[0], n[1], n[2], n[3] < 0 ? -n[3] : n[3]}};
#else
    using Bits = std::int64_t __attribute__((vector_size(32)));
    return {(Numbers)((Bits)n & Bits{-1, -1, -1, INT64_MAX})};
#endif
  }
  /// The same with 0 in the fourth place.
  CDEM_HD Row xyz() const {
#if defined(CDEM_CUDA)
    return of(n[0], n[1], n[2]);
#else
    using Bits = std::int64_t __attribute__((vector_size(32)));
    return {(Numbers)((Bits)n & Bits{-1, -1, -1, 0})};
#endif
  }
};

#if defined(CDEM_CUDA)
CDEM_HD inline Row operator+(const Row& a, const Row& b) {
  return {{a.n[0] + b.n[0], a.n[1] + b.n[1], a.n[2] + b.n[2], a.n[3] + b.n[3]}};
}
CDEM_HD inline Row operator-(const Row& a, const Row& b) {
  return {{a.n[0] - b.n[0], a.n[1] - b.n[1], a.n[2] - b.n[2], a.n[3] - b.n[3]}};
}
CDEM_HD inline Row operator*(Real s, const Row& a) {
  return {{s * a.n[0], s * a.n[1], s * a.n[2], s * a.n[3]}};
}
CDEM_HD inline Row operator/(const Row& a, Real s) {
  return {{a.n[0] / s, a.n[1] / s, a.n[2] / s, a.n[3] / s}};
}
#else
inline Row operator+(const Row& a, const Row& b) { return {a.n + b.n}; }
inline Row operator-(const Row& a, const Row& b) { return {a.n - b.n}; }
inline Row operator*(Real s, const Row& a) { return {s * a.n}; }
inline Row operator/(const Row& a, Real s) { return {a.n / s}; }
#endif

/// Rows r0, r1, r2.
template <class T>
struct Mat3 {
  Vec3<T> r0, r1, r2;
};

template <class T>
CDEM_HD inline Vec3<T> operator*(const Mat3<T>& m, const Vec3<T>& a) {
  return {dot(m.r0, a), dot(m.r1, a), dot(m.r2, a)};
}
template <class T>
CDEM_HD inline Mat3<T> operator+(const Mat3<T>& a, const Mat3<T>& b) {
  return {a.r0 + b.r0, a.r1 + b.r1, a.r2 + b.r2};
}
template <class T>
CDEM_HD inline Mat3<T> operator-(const Mat3<T>& a, const Mat3<T>& b) {
  return {a.r0 - b.r0, a.r1 - b.r1, a.r2 - b.r2};
}
template <class T>
CDEM_HD inline Mat3<T> operator*(const T& s, const Mat3<T>& a) {
  return {s * a.r0, s * a.r1, s * a.r2};
}
template <class T>
CDEM_HD inline Mat3<T> transpose(const Mat3<T>& m) {
  return {{m.r0.x, m.r1.x, m.r2.x}, {m.r0.y, m.r1.y, m.r2.y}, {m.r0.z, m.r1.z, m.r2.z}};
}
template <class T>
CDEM_HD inline Mat3<T> operator*(const Mat3<T>& a, const Mat3<T>& b) {
  const Mat3<T> c = transpose(b);
  return {{dot(a.r0, c.r0), dot(a.r0, c.r1), dot(a.r0, c.r2)},
          {dot(a.r1, c.r0), dot(a.r1, c.r1), dot(a.r1, c.r2)},
          {dot(a.r2, c.r0), dot(a.r2, c.r1), dot(a.r2, c.r2)}};
}
template <class T>
CDEM_HD inline Mat3<T> identity() {
  const T o(1.0), z(0.0);
  return {{o, z, z}, {z, o, z}, {z, z, o}};
}
/// a b^T added to m.
template <class T>
CDEM_HD inline void add_outer(Mat3<T>& m, const Vec3<T>& a, const Vec3<T>& b) {
  m.r0 = m.r0 + a.x * b;
  m.r1 = m.r1 + a.y * b;
  m.r2 = m.r2 + a.z * b;
}
/// Cofactor matrix: det(m) m^-T.
template <class T>
CDEM_HD inline Mat3<T> cofactor(const Mat3<T>& m) {
  return {cross(m.r1, m.r2), cross(m.r2, m.r0), cross(m.r0, m.r1)};
}
template <class T>
CDEM_HD inline T determinant(const Mat3<T>& m) {
  return dot(m.r0, cross(m.r1, m.r2));
}
template <class T>
CDEM_HD inline Mat3<T> inverse(const Mat3<T>& m) {
  const Mat3<T> c = cofactor(m);
  return (T(1.0) / dot(m.r0, c.r0)) * transpose(c);
}

/// Symmetric tensor, ordered as everywhere: xx, yy, zz, xy, yz, zx (tensor shear, not doubled).
template <class T>
struct Sym3 {
  T xx, yy, zz, xy, yz, zx;
};

template <class T>
CDEM_HD inline Sym3<T> operator+(const Sym3<T>& a, const Sym3<T>& b) {
  return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.yz + b.yz, a.zx + b.zx};
}
template <class T>
CDEM_HD inline Sym3<T> operator-(const Sym3<T>& a, const Sym3<T>& b) {
  return {a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.yz - b.yz, a.zx - b.zx};
}
template <class M, class T>
CDEM_HD inline Sym3<T> select(const M& mask, const Sym3<T>& yes, const Sym3<T>& no) {
  return {select(mask, yes.xx, no.xx), select(mask, yes.yy, no.yy), select(mask, yes.zz, no.zz),
          select(mask, yes.xy, no.xy), select(mask, yes.yz, no.yz), select(mask, yes.zx, no.zx)};
}
template <class T>
CDEM_HD inline Sym3<T> operator*(const T& s, const Sym3<T>& a) {
  return {s * a.xx, s * a.yy, s * a.zz, s * a.xy, s * a.yz, s * a.zx};
}
template <class T>
CDEM_HD inline T trace(const Sym3<T>& a) {
  return a.xx + a.yy + a.zz;
}
/// a : b, the double contraction.
template <class T>
CDEM_HD inline T contract(const Sym3<T>& a, const Sym3<T>& b) {
  return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz +
         T(2.0) * (a.xy * b.xy + a.yz * b.yz + a.zx * b.zx);
}
template <class T>
CDEM_HD inline Sym3<T> symmetric(const Mat3<T>& m) {
  const T half(0.5);
  return {m.r0.x,
          m.r1.y,
          m.r2.z,
          half * (m.r0.y + m.r1.x),
          half * (m.r1.z + m.r2.y),
          half * (m.r2.x + m.r0.z)};
}
template <class T>
CDEM_HD inline Mat3<T> full(const Sym3<T>& a) {
  return {{a.xx, a.xy, a.zx}, {a.xy, a.yy, a.yz}, {a.zx, a.yz, a.zz}};
}
/// Change the trace of a symmetric tensor to `value`, leaving its deviator.
template <class T>
CDEM_HD inline Sym3<T> with_trace(const Sym3<T>& a, const T& value) {
  const T shift = (value - trace(a)) / T(3.0);
  return {a.xx + shift, a.yy + shift, a.zz + shift, a.xy, a.yz, a.zx};
}

/// The antisymmetric A that makes (s + A) u symmetric, u symmetric: A u + u A = u s - s u, which is
/// (tr(u) I - u) a = w for their axial vectors.
template <class T>
CDEM_HD inline Mat3<T> balancing(const Sym3<T>& s, const Mat3<T>& u) {
  const T none(0.0), all = u.r0.x + u.r1.y + u.r2.z;
  const Mat3<T> turn = u * full(s) - full(s) * u;
  const Vec3<T> a = inverse(all * identity<T>() - u) * Vec3<T>{turn.r2.y, turn.r0.z, turn.r1.x};
  return {{none, -a.z, a.y}, {a.z, none, -a.x}, {-a.y, a.x, none}};
}

/// A Newton step towards the rotation of F = R U: R <- (R + R^-T) / 2 (Higham 1986).
template <class T>
CDEM_HD inline Mat3<T> nearer_rotation(const Mat3<T>& r) {
  const Mat3<T> c = cofactor(r);
  const T inverse_det = T(1.0) / dot(r.r0, c.r0);
  return T(0.5) * (r + inverse_det * c);
}

/// Rotation of F = R U by three Newton steps, no branches.
///
/// The error after a step is half the square of the one before: from a strain of 10 % it is 1e-10
/// after three, from 1 % it is round-off.
template <class T>
CDEM_HD inline Mat3<T> polar_rotation(const Mat3<T>& f) {
  Mat3<T> r = f;
  for (int step = 0; step < 3; ++step) r = nearer_rotation(r);
  return r;
}

/// Principal values of a symmetric tensor, the largest first, and their unit directions.
template <class T>
struct PrincipalAxes {
  Vec3<T> value;
  Vec3<T> axis[3];
};

/// Principal values and directions by four sweeps of cyclic Jacobi rotations, no branches: the
/// error is a few round-offs of the norm, also where values are nearly equal.
template <class T>
CDEM_HD inline PrincipalAxes<T> principal_axes(const Sym3<T>& tensor) {
  const T zero(0.0), one(1.0);
  T on[3] = {tensor.xx, tensor.yy, tensor.zz};
  T off[3] = {tensor.yz, tensor.zx, tensor.xy};  // of the two other axes
  Vec3<T> axis[3] = {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
  for (int turn = 0; turn < 12; ++turn) {
    const int r = turn % 3, p = (r + 1) % 3, q = (r + 2) % 3;
    const T gap = on[q] - on[p], twice = off[r] + off[r];
    const T size = abs_of(gap) + sqrt_of(gap * gap + twice * twice);
    const T t = select(size > zero, select(gap < zero, -twice, twice) / size, zero);
    const T c = one / sqrt_of(one + t * t), s = t * c;
    on[p] -= t * off[r];
    on[q] += t * off[r];
    off[r] = zero;
    const T off_q = off[q];  // of r and p
    off[q] = c * off_q - s * off[p];
    off[p] = s * off_q + c * off[p];
    const Vec3<T> axis_p = axis[p];
    axis[p] = c * axis_p - s * axis[q];
    axis[q] = s * axis_p + c * axis[q];
  }
  const auto sort = [&](int a, int b) {
    const auto swap = on[b] > on[a];
    const T value = on[a];
    const Vec3<T> direction = axis[a];
    on[a] = select(swap, on[b], value);
    on[b] = select(swap, value, on[b]);
    axis[a] = select(swap, axis[b], direction);
    axis[b] = select(swap, direction, axis[b]);
  };
  sort(0, 1);
  sort(1, 2);
  sort(0, 1);
  return {{on[0], on[1], on[2]}, {axis[0], axis[1], axis[2]}};
}

}  // namespace cdem
