// relaxation.cpp - see relaxation.hpp.
#include "core/nodes/relaxation.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/exact_sum.hpp"
#include "core/base/parallel.hpp"
#include "core/nodes/nodes.hpp"
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

/// Forces on nodes less what damping adds, one component  [N].
struct Undamped {
  const Real *force, *damping;
  explicit Undamped(const State& s)
      : force(on_host(s.nodes.force).data()), damping(damping_forces(s)) {}
  Real operator()(std::size_t i, std::size_t k) const {
    return damping ? force[4 * i + k] - damping[4 * i + k] : force[4 * i + k];
  }
};

/// Remember forces and velocities of a step; no node has been slowed down since.
void remember(const Model& m, State& s) {
  const Undamped undamped(s);
  const auto motion = on_host(s.nodes.motion), before = on_host(s.nodes.relax);
#pragma omp parallel for schedule(static) if (m.node_count >= worth_threads)
  for (std::size_t i = 0; i < std::size_t(m.node_count); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      before[8 * i + k] = undamped(i, k);
      before[8 * i + 4 + k] = motion[8 * i + 4 + k];
    }
    before[8 * i + 3] = 1;
  }
}

/// Nodes that were slowed down at the time of the forces moved with their old velocity until then:
/// book what the forces have done on the half step that their new velocity lacks.
void book_slowed(const Model& m, State& s) {
  const Undamped undamped(s);
  const LoadColumns loads = on_host(load_columns(m, s));
  const SupportColumns supports = on_host(support_columns(m, s));
  const auto relax = on_host(s.nodes.relax), work_external = on_host(s.nodes.work_external);
  s.stopped_energy += exact_sum(m.node_count, [&](Index i) {
    const Real* before = relax.data() + 8 * std::size_t(i);
    const Row way = supports.without_given(
        i, (0.5 * s.dt_last * (1 - before[3])) * Row::of(before[4], before[5], before[6]));
    work_external[i] += dot(loads.at(i).vector(), way.vector());
    return dot(Vec3<Real>{undamped(i, 0), undamped(i, 1), undamped(i, 2)}, way.vector());
  });
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
  const Undamped undamped(s);
  const auto before = on_host(s.nodes.relax);
  const Real stiff = exact_sum(m.node_count, [&](std::size_t i) {
    Real sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
      sum -= before[8 * i + 4 + k] * (undamped(i, k) - before[8 * i + k]);
    return sum;
  });
  const auto mass = on_host(lumped_masses(m, s));
  const Real heavy = exact_sum(m.node_count, [&](std::size_t i) {
    const Real* v = before.data() + 8 * i + 4;
    return mass[i] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  });
  // the damping force lags by half a step, so w dt < sqrt(4 - 2 c dt) must hold for the fastest
  // mode
  const Real most = 1.8 * (1 - relax_safety * relax_safety) / s.dt_last;
  const Real critical = heavy > 0 && stiff > 0 ? 2 * std::sqrt(stiff / (s.dt_last * heavy)) : 0;
  s.relax_damping = std::min(critical, most);
  remember(m, s);
}

}  // namespace cdem
