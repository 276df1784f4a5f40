// unbalance.cpp - see unbalance.hpp.
#include "core/diagnostics/unbalance.hpp"

#include "core/base/primitives.hpp"
#include "core/diagnostics/force_terms.hpp"
#include "core/diagnostics/round_off.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

Real unbalance_ratio(const Model& m, const State& s) {
  const Queue q;
  const Counted nodes = s.share.counted("nodes");
  const Real unbalanced = column_sum(q, s.nodes.unbalance, nodes);
  // forces on supports need no balance: a heavy fixed bed must not hide a block that slides
  Real applied = exact_sum(
      q, m.node_count, AppliedForce{.loads = load_columns(m, s), .supports = support_columns(m, s)},
      nodes);
  if (applied == 0)  // moved by its supports alone: compare with the forces that they carry
    applied = exact_sum(q, m.node_count, CarriedForce{s.nodes.reaction.data()}, nodes);
  return unbalanced > RoundOff(m, s).force ? unbalanced / applied : 0;
}

}  // namespace cdem
