// draws.hpp - random strength of pairs of an interface. Weibull (1951).
#pragma once

#include <cstdint>

#include "core/base/elementary.hpp"

namespace cdem {

/// A number from 0 to 1, both excluded, for each pair of faces and seed: a hash of the three (the
/// finalizer of splitmix64), so that it depends on nothing else.
inline Real uniform_draw(std::uint64_t seed, Index a, Index b) {
  const auto mix = [](std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
  };
  const std::uint64_t low = std::uint32_t(a < b ? a : b), high = std::uint32_t(a < b ? b : a);
  const std::uint64_t hash = mix(mix(seed + 0x9e3779b97f4a7c15ULL) ^ (high << 32 | low));
  return (Real(hash >> 12) + 0.5) * 0x1p-52;
}

/// Factor on the strength of a pair: a draw of Weibull's distribution with this shape, over
/// `mean`, the mean of the distribution: Gamma(1 + 1 / shape).
inline Real weibull_factor(std::uint64_t seed, Index a, Index b, Real shape, Real mean) {
  return exp_of(log_of(-log_of(uniform_draw(seed, a, b))) / shape) / mean;
}

}  // namespace cdem
