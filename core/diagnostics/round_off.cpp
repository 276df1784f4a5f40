// round_off.cpp - see round_off.hpp.
#include "core/diagnostics/round_off.hpp"

#include <limits>

#include "core/base/primitives.hpp"
#include "core/diagnostics/force_terms.hpp"

namespace cdem {

RoundOff::RoundOff(const Model& m, const State& s) {
  const Most farthest = most({}, m.node_count, Farthest{s.nodes.motion.data()});
  shift = std::numeric_limits<Real>::epsilon() * max_of(farthest.value, 0.0);
  force = shift * exact_sum({}, m.node_count,
                            NodeStiffness{.mass = m.mass.data(),
                                          .frequency_squared = m.lumped_frequency_squared.data()});
}

}  // namespace cdem
