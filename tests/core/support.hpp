// support.hpp - random inputs from a fixed seed, and comparisons.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>

#include "core/base/math.hpp"

namespace cdem::test {

using Vec = Vec3<Real>;
using Mat = Mat3<Real>;

/// Random numbers that are the same in every run.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  Real between(Real low, Real high) { return low + (high - low) * Real(engine_() >> 11) * 0x1p-53; }
  Index below(Index count) { return Index(engine_() % std::uint64_t(count)); }
  /// Components from -size to size.
  Vec vector(Real size) {
    return {between(-size, size), between(-size, size), between(-size, size)};
  }
  Vec direction() {
    for (;;) {
      const Vec v = vector(1);
      const Real length = norm(v);
      if (length > 0.1 && length < 1) return Real(1 / length) * v;
    }
  }
  Mat matrix(Real size) { return {vector(size), vector(size), vector(size)}; }
  /// Any rotation.
  Mat rotation() {
    const Vec a = direction(), b = unit(cross(a, direction()));
    return {a, b, cross(a, b)};
  }
  /// A symmetric matrix with eigenvalues from 1 - strain to 1 + strain, both reached.
  Mat stretch(Real strain) {
    const Mat r = rotation();
    const Vec size{1 - strain, 1 + strain, between(1 - strain, 1 + strain)};
    return transpose(r) * Mat{size.x * r.r0, size.y * r.r1, size.z * r.r2};
  }

 private:
  std::mt19937_64 engine_;
};

inline bool same_bits(Real a, Real b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

inline Real relative_error(Real a, Real b) {
  return std::abs(a - b) / std::max(std::abs(a), std::abs(b));
}
inline Real distance(const Vec& a, const Vec& b) { return norm(a - b); }
inline Real distance(const Mat& a, const Mat& b) {
  return std::max({distance(a.r0, b.r0), distance(a.r1, b.r1), distance(a.r2, b.r2)});
}

/// The vector that begins at a place of a list, and back.
template <class T>
Vec3<T> vector_at(const T* list) {
  return {list[0], list[1], list[2]};
}
template <class T>
void put(T* list, const Vec3<T>& v) {
  list[0] = v.x, list[1] = v.y, list[2] = v.z;
}

#if !defined(__CUDACC__)
/// Check that a law gives for a lane of numbers the bits that it gives for each of them. `law`
/// makes `outputs` numbers of `inputs`, which `draw` makes up.
template <int inputs, int outputs, class Law, class Draw>
void check_lanes(const Law& law, const Draw& draw) {
  constexpr int rounds = 100;
  int differ = 0;
  for (int round = 0; round < rounds; ++round) {
    Real one_in[lanes][inputs], one_out[lanes][outputs];
    Pack in[inputs], out[outputs];
    for (Index j = 0; j < lanes; ++j) {
      draw(one_in[j]);
      law(static_cast<const Real*>(one_in[j]), one_out[j]);
    }
    for (int k = 0; k < inputs; ++k) in[k] = pack_of([&](Index j) { return one_in[j][k]; });
    law(static_cast<const Pack*>(in), out);
    for (int k = 0; k < outputs; ++k)
      for (Index j = 0; j < lanes; ++j) differ += !same_bits(out[k].n[j], one_out[j][k]);
  }
  CHECK(differ == 0);
}

#endif

}  // namespace cdem::test
