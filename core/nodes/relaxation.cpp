// relaxation.cpp - see relaxation.hpp.
#include "core/nodes/relaxation.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"
#include "core/base/primitives.hpp"
#include "core/nodes/nodes.hpp"
#include "core/nodes/relaxing_node.hpp"
#include "core/nodes/time_step.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

/// Kinetic relaxation: stop all motion when the kinetic energy has passed a peak.
void relax_kinetically(const Model& m, State& s) {
  const Real kinetic = kinetic_energy(m, s);
  s.stop_due = kinetic < s.kinetic_peak;
  s.kinetic_peak = s.stop_due ? 0 : kinetic;
}

namespace {

Undamped undamped_forces(const State& s) {
  return {.force = s.nodes.force.data(), .damping = damping_forces(s)};
}

/// Remember forces and velocities of a step; no node has been slowed down since.
void remember(const Model& m, State& s) {
  for_each_item({}, m.node_count,
                RememberNode{.undamped = undamped_forces(s),
                             .motion = s.nodes.motion.data(),
                             .remembered = s.nodes.relax.data()});
}

/// Book the work of slowed nodes until then.
void book_slowed(const Model& m, State& s) {
  s.stopped_energy += exact_sum({}, m.node_count,
                                SlowedWork{.undamped = undamped_forces(s),
                                           .loads = load_columns(m, s),
                                           .supports = support_columns(m, s),
                                           .remembered = s.nodes.relax.data(),
                                           .half_step = 0.5 * s.dt_last,
                                           .work_external = s.nodes.work_external.data()},
                                s.share.counted("nodes"));
}

}  // namespace

void scale_masses_if_due(const Model& m, State& s) {
  if (s.nodes.relax.size() == 0) {
    s.nodes.relax.resize(8 * std::size_t(m.node_count));
    remember(m, s);
    s.dt_stable = s.dt;
    scale_masses(m, s);
  } else if (step_is_due(s)) {
    renew_step(m, s);
  }
}

/// Adaptive relaxation: damp critically the mode that moves now. Its frequency is the Rayleigh
/// quotient of the last displacement, v . K v / v . M v, with K v from the change of the forces.
void relax_adaptively(const Model& m, State& s) {
  book_slowed(m, s);
  const Real* remembered = s.nodes.relax.data();
  const Real stiff = exact_sum(
      {}, m.node_count, StiffnessInMotion{.undamped = undamped_forces(s), .remembered = remembered},
      s.share.counted("nodes"));
  const Real heavy = exact_sum(
      {}, m.node_count, MassInMotion{.mass = lumped_masses(m, s).data(), .remembered = remembered},
      s.share.counted("nodes"));
  // the damping force lags by half a step, so w dt < sqrt(4 - 2 c dt) must hold for the fastest
  // mode
  const Real most = 1.8 * (1 - relax_safety * relax_safety) / s.dt_last;
  const Real critical = heavy > 0 && stiff > 0 ? 2 * std::sqrt(stiff / (s.dt_last * heavy)) : 0;
  s.relax_damping = std::min(critical, most);
  remember(m, s);
}

}  // namespace cdem
