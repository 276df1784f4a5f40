// masses.cpp - see masses.hpp.
#include "core/nodes/masses.hpp"

#include <algorithm>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/base/primitives.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/node_energy.hpp"
#include "core/nodes/relaxing_node.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

namespace {

KineticEnergy kinetic_energies(const Model& m, const State& s) {
  return {.nodes = {s.nodes.motion.data()}, .mass = mass_columns(m, s)};
}

}  // namespace

Real energy_of_motion(const Model& m, const State& s) {
  return exact_sum({}, m.node_count, kinetic_energies(m, s));
}

namespace {

/// Change the masses that move; the kinetic energy it takes is booked, and taken from the last
/// sample, which holds the energy of the masses before.
template <class Change>
void book_change(const Model& m, State& s, Change&& change) {
  const Real before = energy_of_motion(m, s);
  const auto count_in_sample = [&](Real sign) {
    const KineticEnergy energy = on_host(kinetic_energies(m, s));
    const auto sample = on_host(s.nodes.sample);
    for (Index i = 0; i < m.node_count; ++i) sample[4 * std::size_t(i)] += sign * energy(One{i});
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
  if (!m.lumped_while_bonded && s.ground.node.size() == 0) {
    if (s.nodes.lumped.size() > 0) book_change(m, s, [&] { s.nodes.lumped.resize(0); });
    return;
  }
  std::vector<Flag> whole(m.node_count), lumped(m.node_count);  // the first by block's first node
  const auto block_first = on_host(m.block_first);
  for (const Index node : on_host(s.ground.node)) whole[block_first[node]] = 1;
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    const auto is_active = activity(ps);
    const auto for_each_node = nodes_of(m, p);
    for (Index i = 0; i < p.count && m.lumped_while_bonded; ++i)
      if (is_active(i)) for_each_node(i, [&](Index node) { whole[block_first[node]] = 1; });
  });
  for (Index i = 0; i < m.node_count; ++i) lumped[i] = whole[block_first[i]];
  const auto change = [&] { s.nodes.lumped.assign(lumped); };
  if (s.nodes.lumped.size() == 0)  // of a new or a restored state: nothing changes
    change();
  else if (!std::equal(lumped.begin(), lumped.end(), on_host(s.nodes.lumped).begin()))
    book_change(m, s, change);
}

void slow_heavier_nodes(const Model& m, State& s) {
  const Real before = energy_of_motion(m, s);
  for_each_item({}, m.node_count,
                SlowNode{.supports = support_columns(m, s),
                         .remembered = s.nodes.relax.data(),
                         .motion = s.nodes.motion.data()});
  s.stopped_energy += before - energy_of_motion(m, s);
}

void stop_motion(const Model& m, State& s) {
  s.stopped_energy += energy_of_motion(m, s);
  s.stopped_energy += exact_sum({}, m.node_count,
                                StopNode{.force = s.nodes.force.data(),
                                         .damping_force = damping_forces(s),
                                         .loads = load_columns(m, s),
                                         .since = 0.5 * s.dt_last,
                                         .motion = s.nodes.motion.data(),
                                         .work_external = s.nodes.work_external.data(),
                                         .work_damping = s.nodes.work_damping.data()});
  s.dt_last = 0;
}

}  // namespace cdem
