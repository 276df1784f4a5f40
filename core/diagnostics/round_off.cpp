// round_off.cpp - see round_off.hpp.
#include "core/diagnostics/round_off.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/exact_sum.hpp"

namespace cdem {

RoundOff::RoundOff(const Model& m, const State& s) {
  const auto motion = on_host(s.nodes.motion);
  Real farthest = 0;  // coordinate
  for (Index i = 0; i < m.node_count; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      farthest = std::max(farthest, std::abs(motion[8 * std::size_t(i) + axis]));
  shift = std::numeric_limits<Real>::epsilon() * farthest;
  const auto mass = on_host(m.mass), frequency_squared = on_host(m.lumped_frequency_squared);
  force = shift * exact_sum(m.node_count, [&](Index i) { return mass[i] * frequency_squared[i]; });
}

}  // namespace cdem
