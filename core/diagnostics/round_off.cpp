// round_off.cpp - see round_off.hpp.
#include "core/diagnostics/round_off.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/exact_sum.hpp"

namespace cdem {

RoundOff::RoundOff(const Model& m, const State& s) {
  Real farthest = 0;  // coordinate
  for (Index i = 0; i < m.node_count; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      farthest = std::max(farthest, std::abs(s.nodes.motion[8 * std::size_t(i) + axis]));
  shift = std::numeric_limits<Real>::epsilon() * farthest;
  force = shift * exact_sum(m.node_count,
                            [&](Index i) { return m.mass[i] * m.lumped_frequency_squared[i]; });
}

}  // namespace cdem
