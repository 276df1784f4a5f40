// masses.cpp - see masses.hpp.
#include "core/nodes/masses.hpp"

#include <algorithm>
#include <vector>

#include "core/base/exact_sum.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

namespace {

/// What a node has of the kinetic energy  [J].
Real energy_of_node(const MassColumns& mass, const InMotion& nodes, Index i) {
  return 0.5 * dot(mass.momentum(nodes, i).vector(), nodes.velocity(i));
}

}  // namespace

Real energy_of_motion(const Model& m, const State& s) {
  const MassColumns mass = on_host(mass_columns(m, s));
  const InMotion nodes = on_host(InMotion{s.nodes.motion.data()});
  return exact_sum(m.node_count, [&](Index i) { return energy_of_node(mass, nodes, i); });
}

namespace {

/// Change the masses that move; what kinetic energy that takes is booked, and taken from the last
/// sample, which holds the energy of the masses before.
template <class Change>
void book_change(const Model& m, State& s, Change&& change) {
  const Real before = energy_of_motion(m, s);
  const auto count_in_sample = [&](Real sign) {
    const MassColumns mass = on_host(mass_columns(m, s));
    const InMotion nodes = on_host(InMotion{s.nodes.motion.data()});
    const auto sample = on_host(s.nodes.sample);
    for (Index i = 0; i < m.node_count; ++i)
      sample[4 * std::size_t(i)] += sign * energy_of_node(mass, nodes, i);
  };
  count_in_sample(-1);
  change();
  count_in_sample(1);
  s.stopped_energy += before - energy_of_motion(m, s);
}

}  // namespace

void change_mass(Model& m, State& s, bool lumped) {
  book_change(m, s, [&] {
    m.lumped = lumped;
    s.nodes.relax_mass.resize(0);
    s.nodes.relax.resize(0);
  });
}

void list_lumped(const Model& m, State& s) {
  if (!m.lumped_while_bonded) {
    if (s.nodes.lumped.size() > 0) book_change(m, s, [&] { s.nodes.lumped.resize(0); });
    return;
  }
  std::vector<Flag> bonded(m.node_count), lumped(m.node_count);  // the first by block's first node
  const auto block_first = on_host(m.block_first);
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    const auto is_active = activity(ps);
    const auto for_each_node = nodes_of(m, p);
    for (Index i = 0; i < p.count; ++i)
      if (is_active(i)) for_each_node(i, [&](Index node) { bonded[block_first[node]] = 1; });
  });
  for (Index i = 0; i < m.node_count; ++i) lumped[i] = bonded[block_first[i]];
  const auto change = [&] { s.nodes.lumped.assign(lumped); };
  if (s.nodes.lumped.size() == 0)  // of a new or a restored state: nothing changes
    change();
  else if (!std::equal(lumped.begin(), lumped.end(), on_host(s.nodes.lumped).begin()))
    book_change(m, s, change);
}

void slow_heavier_nodes(const Model& m, State& s) {
  const Real before = energy_of_motion(m, s);
  const SupportColumns supports = on_host(support_columns(m, s));
  const auto relax = on_host(s.nodes.relax), motion = on_host(s.nodes.motion);
  for (Index i = 0; i < m.node_count; ++i) {
    const Real ratio = relax[8 * std::size_t(i) + 3];
    for (Index axis = 0; axis < 3; ++axis)
      if (!supports.given(i, axis)) motion[8 * std::size_t(i) + 4 + axis] *= ratio;
  }
  s.stopped_energy += before - energy_of_motion(m, s);
}

void stop_motion(const Model& m, State& s) {
  const LoadColumns loads = on_host(load_columns(m, s));
  const Real* damping = on_host(damping_forces(s));
  const auto motion = on_host(s.nodes.motion), force = on_host(s.nodes.force);
  const auto work_external = on_host(s.nodes.work_external);
  const auto work_damping = on_host(s.nodes.work_damping);
  s.stopped_energy += energy_of_motion(m, s);
  // the forces of this moment have worked since the middle of the last step
  s.stopped_energy += exact_sum(m.node_count, [&](Index i) {
    Real* v = motion.data() + std::size_t(i) * 8 + 4;
    const Vec3<Real> way = 0.5 * s.dt_last * Vec3<Real>{v[0], v[1], v[2]};
    work_external[i] += dot(loads.at(i).vector(), way);
    if (damping) work_damping[i] -= dot(Row::at(damping + std::size_t(i) * 4).vector(), way);
    v[0] = v[1] = v[2] = 0;
    return dot(Row::at(force.data() + std::size_t(i) * 4).vector(), way);
  });
  s.dt_last = 0;
}

}  // namespace cdem
