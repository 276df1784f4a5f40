// time_step.cpp - see time_step.hpp.
#include "core/nodes/time_step.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/phase_timer.hpp"
#include "core/nodes/masses.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

namespace {

/// What a dashpot of ratio xi at the highest frequency leaves of the stable step.
Real damped(Real xi) { return std::sqrt(1 + xi * xi) - xi; }

/// What strong contact dashpots leave of that.
Real strongly_damped(Real xi) {
  if (xi <= sure_contact_damping) return 1;
  // one over damped(xi), which is rounded to zero where xi is large
  const Real undamped = std::hypot(1, xi) + xi;
  return sure_contact_damping * damped(sure_contact_damping) * undamped / xi;
}

/// Stiffness of bonds and contacts, those that may begin included, on a node  [N/m].
Real stiffness_at(const State& s, Index i) {
  return std::max(s.nodes.force[std::size_t(i) * 4 + 3], s.node_potential[i]) + s.node_bonds[i];
}

bool is_held(const SupportColumns& supports, Index node) {
  return supports.given(node, 0) && supports.given(node, 1) && supports.given(node, 2);
}

/// What part of a bound of the squared frequency of a block with a mass matrix its nodes leave, one
/// by one: K <= diag(S + 2 k), M >= diag(least). All of it where no such diagonal is known.
Real part_of_bound(const Model& m, const State& s, Range block, Real bound) {
  if (m.least_mass.size() == 0) return 1;
  const SupportColumns supports = support_columns(m, s);
  Real largest = 0;
  for (Index j = block.first; j < block.last; ++j) {
    if (is_held(supports, j)) continue;
    const Real elements = m.mass[j] * m.lumped_frequency_squared[j];
    largest = std::max(largest, (elements + 2 * stiffness_at(s, j)) / m.least_mass[j]);
  }
  return largest < bound ? largest / bound : 1;
}

/// Node with the highest frequency; `held` counts those that are held or driven in all directions.
Real highest_frequency_squared(const Model& m, const State& s, bool held, StepLimit& limit) {
  Real largest = -1;
  const MassColumns mass = mass_columns(m, s);
  const SupportColumns supports = support_columns(m, s);
  for (Index i = 0; i < m.node_count; ++i) {
    Real stiffness = 0;
    const bool dense = mass.row(i) >= 0;
    const Index first = dense ? m.block_first[i] : i;
    const Index last = dense ? first + m.block_count[i] : i + 1;
    if (dense && i != first) continue;
    Real element_frequency_squared = 0;
    Index stiffest = i;  // of the nodes of a block with a mass matrix
    bool free = held;
    for (Index j = first; j < last; ++j) {
      free = free || !is_held(supports, j);
      if (const Real here = stiffness_at(s, j); here > stiffness) {
        stiffness = here;
        stiffest = j;
      }
      element_frequency_squared =
          std::max(element_frequency_squared,
                   mass.is_lumped(j) ? m.lumped_frequency_squared[j] : m.frequency_squared[j]);
    }
    if (!free) continue;
    // Gershgorin: a spring between two points adds at most twice its stiffness to a row
    Real contact_frequency_squared =
        2 * stiffness * (mass.is_lumped(i) ? 1 / m.mass[i] : m.inverse_mass_bound[i]);
    const Real part = dense ? part_of_bound(m, s, {first, last},
                                            element_frequency_squared + contact_frequency_squared)
                            : 1;
    element_frequency_squared *= part;
    contact_frequency_squared *= part;
    if (element_frequency_squared + contact_frequency_squared > largest) {
      largest = element_frequency_squared + contact_frequency_squared;
      limit.node = stiffest;
      limit.element_frequency_squared = element_frequency_squared;
      limit.contact_frequency_squared = contact_frequency_squared;
      limit.bond_part = stiffness > 0 ? s.node_bonds[stiffest] / stiffness : 0;
    }
  }
  return largest;
}

}  // namespace

StepLimit step_limit(const Model& m, const State& s) {
  StepLimit limit;
  // what is held or driven in all directions cannot become unstable; where nothing else is, its
  // step still is what curves, histories and ends of stages are followed with
  Real largest = highest_frequency_squared(m, s, false, limit);
  if (!(largest > 0)) largest = highest_frequency_squared(m, s, true, limit);
  // a dashpot of ratio xi at the highest frequency shortens the stable step by this factor
  const Real xi =
      m.stiffness_damping + m.contact_damping + 0.5 * m.damping.mass / std::sqrt(largest);
  limit.dt = 2 / std::sqrt(largest) * damped(xi) / std::sqrt(1 + m.damping.local) *
             strongly_damped(m.contact_damping);
  return limit;
}

void renew_step(const Model& m, State& s) {
  if (s.nodes.relax_mass.size() > 0) {  // its masses are made for any step
    s.dt_stable = s.dt;
    scale_masses(m, s);
    return;
  }
  const StepLimit limit = m.step_given > 0 ? StepLimit{} : step_limit(m, s);
  const Real stable = m.step_given > 0 ? m.step_given : m.step_safety * limit.dt;
  const bool at_once = m.step_given > 0 || !(s.dt > 0);
  s.dt = at_once ? stable : std::min(s.dt, stable);
  const bool flies = limit.contact_frequency_squared < limit.element_frequency_squared;
  s.dt_stable = !at_once && flies ? std::max(s.dt, flight_growth * stable) : stable;
}

bool step_is_due(const State& s) {
  return has_contact_pairs(s) || s.step % step_check_interval == 0;
}

void advance_clock(const Model& m, State& s) {
  const PhaseTimer timer(s, Phase::node);
  s.dt_last = s.dt;
  s.time += s.dt;
  s.step += 1;
  s.dt = std::min(step_growth * s.dt, s.dt_stable);
  // more contacts may press on a node than the pair list expects; scaled masses follow later, when
  // a sample of this step has been taken
  if (s.nodes.relax_mass.size() > 0 || !step_is_due(s)) return;
  if (has_contact_pairs(s)) return renew_step(m, s);
  const Transfer transfer;  // a check at long intervals
  renew_step(m, s);
}

void scale_masses(const Model& m, State& s) {
  const StepLimit limit = step_limit(m, s);
  const Real part = s.dt / (relax_safety * limit.dt);
  const Real squared =
      (limit.element_frequency_squared + limit.contact_frequency_squared) / (part * part);
  const Real before = energy_of_motion(m, s);
  s.nodes.relax_mass.assign(lumped_masses(m, s).data(), m.node_count);
  for (Index i = 0; i < m.node_count; ++i) {
    Real& mass = s.nodes.relax_mass[i];
    const Real needed =
        (m.mass[i] * m.lumped_frequency_squared[i] + 2 * stiffness_at(s, i)) / squared;
    if (needed > mass && s.nodes.relax.size() > 0)
      s.nodes.relax[8 * std::size_t(i) + 3] *= mass / needed;
    mass = needed;
  }
  s.stopped_energy += before - energy_of_motion(m, s);
}

}  // namespace cdem
