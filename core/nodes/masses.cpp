// masses.cpp - see masses.hpp.
#include "core/nodes/masses.hpp"

#include "core/base/reduce.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

namespace {

/// What a node has of the kinetic energy  [J].
Real energy_of_node(const MassColumns& mass, const State& s, Index i) {
  const InMotion nodes{s.nodes.motion.data()};
  return 0.5 * dot(mass.momentum(nodes, i).vector(), nodes.velocity(i));
}

}  // namespace

Real energy_of_motion(const Model& m, const State& s) {
  const MassColumns mass = mass_columns(m, s);
  return ordered_sum(m.node_count, [&](Index i) { return energy_of_node(mass, s, i); });
}

void change_mass(Model& m, State& s, bool lumped) {
  const Real before = energy_of_motion(m, s);
  // the last sample holds the energy of the masses before
  const auto count_in_sample = [&](Real sign) {
    const MassColumns mass = mass_columns(m, s);
    for (Index i = 0; i < m.node_count; ++i)
      s.nodes.sample[4 * std::size_t(i)] += sign * energy_of_node(mass, s, i);
  };
  count_in_sample(-1);
  m.lumped = lumped;
  s.nodes.relax_mass.resize(0);
  s.nodes.relax.resize(0);
  count_in_sample(1);
  s.stopped_energy += before - energy_of_motion(m, s);
}

void slow_heavier_nodes(const Model& m, State& s) {
  const Real before = energy_of_motion(m, s);
  const SupportColumns supports = support_columns(m, s);
  for (Index i = 0; i < m.node_count; ++i) {
    const Real ratio = s.nodes.relax[8 * std::size_t(i) + 3];
    for (Index axis = 0; axis < 3; ++axis)
      if (!supports.given(i, axis)) s.nodes.motion[8 * std::size_t(i) + 4 + axis] *= ratio;
  }
  s.stopped_energy += before - energy_of_motion(m, s);
}

void stop_motion(const Model& m, State& s) {
  const LoadColumns loads = load_columns(m, s);
  const Real* damping = damping_forces(s);
  s.stopped_energy += energy_of_motion(m, s);
  // the forces of this moment have worked since the middle of the last step
  s.stopped_energy += ordered_sum(m.node_count, [&](Index i) {
    Real* v = s.nodes.motion.data() + std::size_t(i) * 8 + 4;
    const Vec3<Real> way = 0.5 * s.dt_last * Vec3<Real>{v[0], v[1], v[2]};
    s.nodes.work_external[i] += dot(loads.at(i).vector(), way);
    if (damping)
      s.nodes.work_damping[i] -= dot(Row::at(damping + std::size_t(i) * 4).vector(), way);
    v[0] = v[1] = v[2] = 0;
    return dot(Row::at(s.nodes.force.data() + std::size_t(i) * 4).vector(), way);
  });
  s.dt_last = 0;
}

}  // namespace cdem
