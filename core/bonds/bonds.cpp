// bonds.cpp - see bonds.hpp.
#include "core/bonds/bonds.hpp"

#include "core/base/parallel.hpp"
#include "core/bonds/views.hpp"
#include "core/model/block_lists.hpp"
#include "core/model/force_sets.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

/// Is the energy of pairs wanted that are intact?
bool wants_energy(const StepPlan& plan) { return plan.sample || plan.everything_awake; }

OutForces corner_forces(State& s, const PairSet& p) {
  return {s.corner_force.data() + std::size_t(p.corner_first) * 4};
}

template <Index count>
void update_bonds(PairKind<ConformingBonds<count>>, const Model& m, State& s, Queue q,
                  const StepPlan& plan, const PairSet& p, PairState& ps) {
  const Real indentation = count == 3 ? m.bond_indentation_triangle : m.bond_indentation_quad;
  with_laws(interface_table(m),
            ConformingBonds<count>{.nodes = {s.nodes.motion.data()},
                                   .pair_nodes = {p.nodes.data(), p.stride},
                                   .pairs = pair_columns(m, p, ps),
                                   .indentation = indentation,
                                   .dt = s.dt_last,
                                   .sampled = wants_energy(plan),
                                   .corner_force = corner_forces(s, p)},
            [&](const auto& kernel) { for_each_lane(q, p.count, awake(plan, ps.awake), kernel); });
}

void update_bonds(PairKind<OverlapBonds>, const Model& m, State& s, Queue q, const StepPlan& plan,
                  const PairSet& p, PairState& ps) {
  with_laws(interface_table(m), overlap_bonds(m, s),
            [&](const auto& kernel) { for_each_item(q, p.count, awake(plan, ps.awake), kernel); });
}

}  // namespace

void update_bond_forces(const Model& m, State& s, Queue q, const StepPlan& plan) {
  const PhaseTimer timer(s, Phase::contact);
  for_each_pair_set(m, s, [&](auto kind, const PairSet& p, PairState& ps) {
    update_bonds(kind, m, s, q, plan, p, ps);
  });
}

}  // namespace cdem
