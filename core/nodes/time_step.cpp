// time_step.cpp - see time_step.hpp.
#include "core/nodes/time_step.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/primitives.hpp"
#include "core/model/phase_timer.hpp"
#include "core/nodes/masses.hpp"
#include "core/nodes/node_frequency.hpp"
#include "core/nodes/views.hpp"
#include "core/ranks/ranks.hpp"

namespace cdem {

namespace {

/// Factor on the stable step by a dashpot of ratio xi at the highest frequency.
Real damped(Real xi) { return std::sqrt(1 + xi * xi) - xi; }

/// Further factor by strong contact dashpots.
Real strongly_damped(Real xi) {
  if (xi <= sure_contact_damping) return 1;
  // one over damped(xi), which is rounded to zero where xi is large
  const Real undamped = std::hypot(1, xi) + xi;
  return sure_contact_damping * damped(sure_contact_damping) * undamped / xi;
}

NodeFrequency node_frequency(const Model& m, const State& s, bool held) {
  return {.mass = mass_columns(m, s),
          .supports = support_columns(m, s),
          .model_mass = m.mass.data(),
          .least_mass = m.least_mass.size() > 0 ? m.least_mass.data() : nullptr,
          .inverse_mass_bound = m.inverse_mass_bound.data(),
          .frequency_squared = m.frequency_squared.data(),
          .lumped_frequency_squared = m.lumped_frequency_squared.data(),
          .force = s.nodes.force.data(),
          .potential = s.node_potential.data(),
          .bonds = s.node_bonds.data(),
          .stiffer = m.maxwell.stiffer(),
          .held = held};
}

/// The highest of all ranks; of those that are equal, of the lowest node.
HighestNode highest_of_ranks(const State& s, HighestNode own) {
  own.node = whole_node(s, own.node);
  HighestNode highest = own;
  for (const HighestNode& one : of_all_ranks(s, own))
    if (one.squared > highest.squared ||
        (one.squared == highest.squared && one.node < highest.node))
      highest = one;
  return highest;
}

/// The highest frequency, squared, and the node that has it.
Real highest_frequency_squared(const Model& m, const State& s, bool held, StepLimit& limit) {
  const NodeFrequency nodes = node_frequency(m, s, held);
  Answer<Most>& most = answer_of_thread<Most>();
  Answer<HighestNode>& answer = answer_of_thread<HighestNode>();
  find_most({}, m.node_count, nodes, s.share.counted("nodes").own, most);
  for_each_item({}, 1, DescribeHighest{nodes, most.data(), answer.data()});
  const HighestNode highest = highest_of_ranks(s, answer.read({}));
  limit.node = highest.node;
  limit.element_frequency_squared = highest.element;
  limit.contact_frequency_squared = highest.contact;
  limit.bond_part = highest.bond_part;
  return highest.squared;
}

}  // namespace

StepLimit step_limit(const Model& m, const State& s) {
  StepLimit limit;
  // nodes fixed or driven in all directions cannot become unstable; without others, their
  // step still resolves curves, histories and ends of stages
  Real largest = highest_frequency_squared(m, s, false, limit);
  if (!(largest > 0)) largest = highest_frequency_squared(m, s, true, limit);
  Real of_modules = 0;
  Modules::for_each([&]<class Module>() {
    if constexpr (requires { Module::frequency_squared(given_of<Module>(m), Real()); })
      of_modules =
          std::max(of_modules, Module::frequency_squared(given_of<Module>(m), m.maxwell.stiffer()));
  });
  for (const Real of_rank : of_all_ranks(s, of_modules)) largest = std::max(largest, of_rank);
  // a dashpot of ratio xi at the highest frequency shortens the stable step by this factor
  const Real rayleigh =
      0.5 * (m.damping.mass / std::sqrt(largest) + m.damping_time * std::sqrt(largest));
  const Real xi = m.stiffness_damping + m.contact_damping + rayleigh;
  limit.dt = 2 / std::sqrt(largest) * damped(xi) / std::sqrt(1 + m.damping.local) *
             strongly_damped(m.contact_damping);
  return limit;
}

Real stable_step(Model& m, const State& s, const StageDamping& damping) {
  const auto exchange = [&m](const StageDamping& d) {
    const StageDamping was{.nodes = m.damping,
                           .stiffness = m.stiffness_damping,
                           .contact = m.contact_damping,
                           .time = m.damping_time,
                           .maxwell = m.maxwell,
                           .lumped = m.lumped};
    m.damping = d.nodes;
    m.stiffness_damping = d.stiffness;
    m.contact_damping = d.contact;
    m.damping_time = d.time;
    m.maxwell = d.maxwell;
    m.lumped = d.lumped;
    return was;
  };
  const StageDamping own = exchange(damping);
  const Real dt = step_limit(m, s).dt;
  exchange(own);
  return dt;
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
  return has_contact_pairs(s) || s.share.pairs_elsewhere || s.step % step_check_interval == 0;
}

void advance_clock(State& s) {
  s.dt_last = s.dt;
  s.time += s.dt;
  s.step += 1;
  s.dt = std::min(step_growth * s.dt, s.dt_stable);
}

void renew_step_if_due(const Model& m, State& s) {
  const PhaseTimer timer(s, Phase::node);
  // scaled masses follow later, when a sample of this step has been taken
  if (s.nodes.relax_mass.size() == 0 && step_is_due(s)) renew_step(m, s);
}

void scale_masses(const Model& m, State& s) {
  const StepLimit limit = step_limit(m, s);
  const Real part = s.dt / (relax_safety * limit.dt);
  const Real squared =
      (limit.element_frequency_squared + limit.contact_frequency_squared) / (part * part);
  const NodeFrequency nodes = on_host(node_frequency(m, s, false));
  const Real before = energy_of_motion(m, s);
  s.nodes.relax_mass.assign(lumped_masses(m, s).data(), m.node_count);
  const auto masses = on_host(s.nodes.relax_mass), relax = on_host(s.nodes.relax);
  for (Index i = 0; i < m.node_count; ++i) {
    const Real elements = nodes.model_mass[i] * nodes.lumped_frequency_squared[i];
    const Real springs = nodes.stiffness_at(i) + nodes.contacts_at(i);
    const Real needed = (elements + 2 * springs) / squared;
    if (needed > masses[i] && relax.size() > 0) relax[8 * std::size_t(i) + 3] *= masses[i] / needed;
    masses[i] = needed;
  }
  to_ghosts(s, s.nodes.relax_mass.data(), {.width = 1, .count = 1});
  s.stopped_energy += before - energy_of_motion(m, s);
}

}  // namespace cdem
