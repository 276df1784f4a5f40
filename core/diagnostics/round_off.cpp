// round_off.cpp - see round_off.hpp.
#include "core/diagnostics/round_off.hpp"

#include <limits>

#include "core/base/primitives.hpp"
#include "core/diagnostics/force_terms.hpp"
#include "core/ranks/ranks.hpp"

namespace cdem {

RoundOff::RoundOff(const Model& m, const State& s) {
  const Counted nodes = s.share.counted("nodes");
  const Most own = most({}, m.node_count, Farthest{s.nodes.motion.data()}, nodes.own);
  Real farthest = 0;
  for (const Real of_rank : of_all_ranks(s, own.value)) farthest = max_of(farthest, of_rank);
  shift = std::numeric_limits<Real>::epsilon() * farthest;
  force = shift * exact_sum({}, m.node_count,
                            NodeStiffness{.mass = m.mass.data(),
                                          .frequency_squared = m.lumped_frequency_squared.data()},
                            nodes);
}

}  // namespace cdem
