// masses.cpp - see masses.hpp.
#include "core/nodes/masses.hpp"

#include <vector>

#include "core/base/primitives.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/lumped_blocks.hpp"
#include "core/nodes/node_energy.hpp"
#include "core/nodes/relaxing_node.hpp"
#include "core/nodes/views.hpp"
#include "core/ranks/ranks.hpp"

namespace cdem {

namespace {

KineticEnergy kinetic_energies(const Model& m, const State& s) {
  return {.nodes = {s.nodes.motion.data()}, .mass = mass_columns(m, s)};
}

}  // namespace

Real energy_of_motion(const Model& m, const State& s) {
  return exact_sum({}, m.node_count, kinetic_energies(m, s), s.share.counted("nodes"));
}

namespace {

/// Change the masses that move; the kinetic energy it takes is booked, and taken from the last
/// sample, which holds the energy of the masses before.
template <class Change>
void book_change(const Model& m, State& s, Change&& change) {
  const Real before = energy_of_motion(m, s);
  const auto count_in_sample = [&](Real sign) {
    for_each_item(
        {}, m.node_count,
        CountInSample{
            .energy = kinetic_energies(m, s), .sign = sign, .sample = s.nodes.sample.data()});
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

namespace {

/// A block that several ranks have is flagged if it is on any of them.
void join_cut_blocks(const Model& m, const State& s, Column<Flag>& whole) {
  if (s.share.cut_blocks == 0) return;
  const Transfer transfer;
  std::vector<std::int64_t> flags(s.share.cut_blocks);
  const auto block = on_host(s.share.cut_block);
  const auto first = on_host(m.block_first);
  const auto flag = on_host(whole);
  for (Index i = 0; i < m.node_count; ++i)
    if (block[i] >= 0) flags[block[i]] |= flag[first[i]];
  s.share.exchange->add_up(flags.data(), s.share.cut_blocks);
  for (Index i = 0; i < m.node_count; ++i)
    if (block[i] >= 0 && flags[block[i]] > 0) flag[first[i]] = 1;
}

/// Flags [node] of the nodes of blocks with dashpots to the ground, or with bonds.
Column<Flag> lumped_nodes(const Model& m, const State& s) {
  Column<Flag> whole, lumped;  // the first by block's first node
  whole.renew(m.node_count);
  lumped.renew(m.node_count);
  set_all({}, m.node_count, whole.data(), Flag(0));
  for_each_item({}, Index(s.ground.node.size()),
                MarkBlocksOfNodes{s.ground.node.data(), m.block_first.data(), whole.data()});
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    if (m.lumped_while_bonded)
      for_each_item({}, p.count,
                    MarkBondedBlocks{.status = ps.status.data(),
                                     .faces = p.faces.data(),
                                     .face_nodes = m.face_nodes.data(),
                                     .block_first = m.block_first.data(),
                                     .whole = whole.data()});
  });
  join_cut_blocks(m, s, whole);
  for_each_item({}, m.node_count, SpreadInBlock{whole.data(), m.block_first.data(), lumped.data()});
  return lumped;
}

}  // namespace

void list_lumped(const Model& m, State& s) {
  Column<Flag>& lumped = s.nodes.lumped;
  if (!m.lumped_while_bonded && s.ground.node.size() == 0) {
    if (lumped.size() > 0) book_change(m, s, [&] { lumped.resize(0); });
    return;
  }
  Column<Flag> now = lumped_nodes(m, s);
  if (lumped.size() == 0)  // of a new or a restored state: nothing changes
    lumped.swap(now);
  else if (any_rank(s, any_item({}, m.node_count, FlagsDiffer{now.data(), lumped.data()})))
    book_change(m, s, [&] { lumped.swap(now); });
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
                                         .work_damping = s.nodes.work_damping.data()},
                                s.share.counted("nodes"));
  s.dt_last = 0;
}

}  // namespace cdem
