// nodes.cpp - see nodes.hpp.
#include "core/nodes/nodes.hpp"

#include "core/base/parallel.hpp"
#include "core/base/primitives.hpp"
#include "core/elements/report.hpp"
#include "core/elements/views.hpp"
#include "core/model/block_lists.hpp"
#include "core/model/force_sets.hpp"
#include "core/model/phase_timer.hpp"
#include "core/nodes/central_difference.hpp"
#include "core/nodes/fused_block.hpp"
#include "core/nodes/masses.hpp"
#include "core/nodes/node_energy.hpp"
#include "core/nodes/peak_speed.hpp"
#include "core/nodes/sleep.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

namespace {

NodeDamping node_damping(const Model& m, const State& s) {
  return {m.damping.local, m.damping.mass + s.relax_damping};
}

/// Where to book the energy that this step hides by being longer or shorter than the last one.
Real* step_change_if_any(State& s) {
  return s.dt != s.dt_last ? s.nodes.step_change.data() : nullptr;
}

template <class Shape, class Flow>
void advance_fused(const Model& m, State& s, Queue q, const StepPlan& plan, const ElementSet& e,
                   ElementState& es, const Flow& flow, bool lumped) {
  const FusedBlocks& fused = es.fused;
  const Column<Index>& blocks = lumped ? fused.lumped : fused.blocks;
  const CorotationalForce<Shape, FollowRotation, Flow> element{
      .columns = element_columns<Shape>(m, s, e),
      .damping_time = m.stiffness_damping * s.dt,
      .dt = s.dt,
      .damping_work = {es.damping_work.data(), e.stride},
      .flow = flow};
  for_each_lane(q, e.count, awake(plan, blocks),
                AdvanceFused<Shape, Flow>{.element = element,
                                          .rows = {fused.row_first.data(), fused.row.data()},
                                          .bond_force = {s.corner_force.data()},
                                          .loads = load_columns(m, s),
                                          .mass = mass_columns(m, s),
                                          .lumped = lumped,
                                          .dt_before = s.dt_last,
                                          .dt = s.dt,
                                          .motion = s.nodes.motion.data(),
                                          .work_external = s.nodes.work_external.data(),
                                          .step_change = step_change_if_any(s)});
}

void advance_fused_blocks(const Model& m, State& s, Queue q, const StepPlan& plan) {
  for_each_element_set(m, s,
                       [&]<class Shape>(ElementKind<Shape>, const ElementSet& e, ElementState& es) {
                         with_flow<Shape>(s, e, es, [&]<class Flow>(const Flow& flow) {
                           if constexpr (has_fused_kernel<Shape, Flow>) {
                             advance_fused<Shape>(m, s, q, plan, e, es, flow, false);
                             advance_fused<Shape>(m, s, q, plan, e, es, flow, true);
                           }
                         });
                       });
}

SumNodeForces node_forces(const Model& m, State& s, bool sampled) {
  const NodeDamping damping = node_damping(m, s);
  const bool damps = damps_nodes(m, s);
  if (damps) s.nodes.damping_force.resize(s.nodes.force.size());
  s.nodes.damped = damps;
  return {.nodes = {s.nodes.motion.data()},
          .ports = node_ports(m, s),
          .supports = support_columns(m, s),
          .damping = damping,
          .mass = mass_columns(m, s),
          .kick = 0.5 * (s.dt_last + s.dt),
          .force = s.nodes.force.data(),
          .damping_force = damps ? s.nodes.damping_force.data() : nullptr,
          .unbalance = sampled ? s.nodes.unbalance.data() : nullptr};
}

template <class Dashing>
MoveNodes<Dashing> node_motion(const Model& m, State& s, const Dashing& ground) {
  return {.mass = mass_columns(m, s),
          .loads = load_columns(m, s),
          .supports = support_columns(m, s),
          .force = s.nodes.force.data(),
          .damping_force = damping_forces(s),
          .dt_before = s.dt_last,
          .dt = s.dt,
          .motion = s.nodes.motion.data(),
          .reaction = s.nodes.reaction.data(),
          .work_external = s.nodes.work_external.data(),
          .work_damping = s.nodes.work_damping.data(),
          .step_change = step_change_if_any(s),
          .ground = ground};
}

/// Call act(dashpots), or act(NoDashpots) where no node has any.
template <class Act>
void with_dashpots(State& s, const Act& act) {
  if (s.ground.node.size() > 0)
    act(dashpots(s));
  else
    act(NoDashpots{});
}

void sample_before(const Model& m, State& s, Queue q) {
  report_elements(m, s, q);
  for_each_item(q, m.node_count,
                NodeMomentum{{s.nodes.motion.data()}, mass_columns(m, s), s.nodes.sample.data()});
}

void sample_after(const Model& m, State& s, Queue q) {
  for_each_item(q, m.node_count,
                SampleNodes{.nodes = {s.nodes.motion.data()},
                            .mass = mass_columns(m, s),
                            .loads = load_columns(m, s),
                            .supports = support_columns(m, s),
                            .reaction = s.nodes.reaction.data(),
                            .damping_force = damping_forces(s),
                            .dt_before = s.dt_last,
                            .dt = s.dt,
                            .sample = s.nodes.sample.data()});
  for_each_item(q, Index(s.ground.node.size()),
                SampleDashpots{.node = s.ground.node.data(),
                               .nodes = {s.nodes.motion.data()},
                               .force = s.ground.force.data(),
                               .dt = s.dt,
                               .sample = s.nodes.radiated_sample.data()});
}

/// Sum the forces first, then move: something looks at the forces in between.
void sum_then_move(const Model& m, State& s, Queue q, const StepPlan& plan) {
  const Blocks nodes = awake(plan, s.nodes.awake);
  for_each_item(q, m.node_count, nodes, node_forces(m, s, true));
  if (plan.stop_motion) stop_motion(m, s);
  if (plan.sample) sample_before(m, s, q);
  with_dashpots(s, [&](const auto& ground) {
    for_each_item(q, m.node_count, nodes, node_motion(m, s, ground));
  });
  if (plan.sample) sample_after(m, s, q);
}

/// Both in one pass over the nodes; fused blocks move with their element forces.
void sum_and_move(const Model& m, State& s, Queue q, const StepPlan& plan) {
  const bool fuses = fuses_blocks(s, plan);
  if (fuses) advance_fused_blocks(m, s, q, plan);
  const SumNodeForces sum = node_forces(m, s, plan.everything_awake);
  const Blocks nodes = awake(plan, fuses ? s.nodes.general : s.nodes.awake);
  with_dashpots(s, [&]<class Dashing>(const Dashing& ground) {
    for_each_item(q, m.node_count, nodes,
                  AdvanceNodes<Dashing>{sum, node_motion(m, s, ground),
                                        fuses ? s.nodes.fused.data() : nullptr});
  });
}

}  // namespace

void sum_forces(const Model& m, State& s, Queue q, const StepPlan& plan) {
  for_each_item(q, m.node_count, awake(plan, s.nodes.awake), node_forces(m, s, true));
}

void advance_nodes(const Model& m, State& s, Queue q, const StepPlan& plan) {
  const PhaseTimer timer(s, Phase::node);
  if (s.nodes.relax.size() > 0) slow_heavier_nodes(m, s);
  if (plan.sample || plan.stop_motion)
    sum_then_move(m, s, q, plan);
  else
    sum_and_move(m, s, q, plan);
  if (s.nodes.keeps_peaks)
    for_each_item(q, m.node_count, KeepPeak{{s.nodes.motion.data()}, s.nodes.peak.data()});
  if (plan.everything_awake) find_awake(m, s);
}

void begin_peaks(const Model& m, State& s) {
  s.nodes.peak.resize(0);
  s.nodes.peak.resize(std::size_t(m.node_count));
}

bool damps_nodes(const Model& m, const State& s) {
  const NodeDamping damping = node_damping(m, s);
  return damping.local > 0 || damping.mass > 0;
}

Real kinetic_energy(const Model& m, const State& s) {
  return exact_sum({}, m.node_count, EachNumber<4>{s.nodes.sample.data()},
                   s.share.counted("nodes"));
}

}  // namespace cdem
