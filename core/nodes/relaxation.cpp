// relaxation.cpp - see relaxation.hpp.
#include "core/nodes/relaxation.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"
#include "core/base/reduce.hpp"
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

/// Adaptive relaxation: damp critically the mode that moves now. Its frequency is the Rayleigh
/// quotient of the last displacement, v . K v / v . M v, with K v from the change of the forces.
void relax_adaptively(const Model& m, State& s) {
  const std::size_t rows = 8 * std::size_t(m.node_count);
  const bool known = s.nodes.relax.size() == rows;
  s.nodes.relax.resize(rows);
  Real* before = s.nodes.relax.data();
  const Real *force = s.nodes.force.data(), *damping = damping_forces(s),
             *motion = s.nodes.motion.data();
  const auto undamped = [&](std::size_t i, std::size_t k) {
    return damping ? force[4 * i + k] - damping[4 * i + k] : force[4 * i + k];
  };
  if (known) {
    const Real stiff = ordered_sum(m.node_count, [&](std::size_t i) {
      Real sum = 0;
      for (std::size_t k = 0; k < 3; ++k)
        sum -= before[8 * i + 4 + k] * (undamped(i, k) - before[8 * i + k]);
      return sum;
    });
    const Column<Real>& mass = lumped_masses(m, s);
    const Real heavy = ordered_sum(m.node_count, [&](std::size_t i) {
      const Real* v = before + 8 * i + 4;
      return mass[i] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    });
    // the damping force lags by half a step, so w dt < sqrt(4 - 2 c dt) must hold for the fastest
    // mode
    const Real most = 1.8 * (1 - relax_safety * relax_safety) / s.dt_last;
    const Real critical = heavy > 0 && stiff > 0 ? 2 * std::sqrt(stiff / (s.dt_last * heavy)) : 0;
    s.relax_damping = std::min(critical, most);
  }
#pragma omp parallel for schedule(static) if (m.node_count >= worth_threads)
  for (std::size_t i = 0; i < std::size_t(m.node_count); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      before[8 * i + k] = undamped(i, k);
      before[8 * i + 4 + k] = motion[8 * i + 4 + k];
    }
}

}  // namespace cdem
