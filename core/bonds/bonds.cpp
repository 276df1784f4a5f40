// bonds.cpp - see bonds.hpp.
#include "core/bonds/bonds.hpp"

#include "core/base/parallel.hpp"
#include "core/bonds/bond_dashpots.hpp"
#include "core/bonds/views.hpp"
#include "core/model/block_lists.hpp"
#include "core/model/force_sets.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

/// Is the energy of pairs wanted that are intact?
bool wants_energy(const StepPlan& plan) { return plan.sample || plan.everything_awake; }

PairDashpots dashpots(const Model& m, const State& s, const PairSet& p, PairState& ps) {
  return {.dt = s.dt_last,
          .per_step = s.dt_last > 0 ? m.damping_time / s.dt_last : 0,
          .force = {ps.dashpot.data(), p.point_stride},
          .work = {ps.damping_work.data(), p.stride}};
}

template <Index count>
void update_bonds(PairKind<ConformingBonds<count>>, const Model& m, State& s, Queue q,
                  const StepPlan& plan, const PairSet& p, PairState& ps) {
  ConformingBonds<count> bonds = conforming_bonds<count>(m, s, p, ps);
  bonds.dt = s.dt_last;
  bonds.sampled = wants_energy(plan);
  bonds.corner_force = corner_forces(s, p);
  const Blocks some = awake(plan, ps.awake);
  with_laws(interface_table(m), bonds,
            [&](const auto& kernel) { for_each_lane(q, p.count, some, kernel); });
  if (ps.dashpot.size() > 0)
    for_each_lane(q, p.count, some,
                  BondDashpots<count>{.bonds = bonds, .dashpots = dashpots(m, s, p, ps)});
}

void update_bonds(PairKind<OverlapBonds>, const Model& m, State& s, Queue q, const StepPlan& plan,
                  const PairSet& p, PairState& ps) {
  const Blocks some = awake(plan, ps.awake);
  const OverlapBonds bonds = overlap_bonds(m, s);
  with_laws(interface_table(m), bonds,
            [&](const auto& kernel) { for_each_item(q, p.count, some, kernel); });
  if (ps.dashpot.size() > 0)
    for_each_item(q, p.count, some,
                  OverlapDashpots{.bonds = bonds, .dashpots = dashpots(m, s, p, ps)});
}

}  // namespace

void update_bond_forces(const Model& m, State& s, Queue q, const StepPlan& plan) {
  const PhaseTimer timer(s, Phase::contact);
  for_each_pair_set(m, s, [&](auto kind, const PairSet& p, PairState& ps) {
    update_bonds(kind, m, s, q, plan, p, ps);
  });
}

}  // namespace cdem
