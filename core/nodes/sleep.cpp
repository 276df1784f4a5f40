// sleep.cpp - see sleep.hpp.
#include "core/nodes/sleep.hpp"

#include <algorithm>
#include <vector>

#include "core/base/primitives.hpp"
#include "core/model/block_lists.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/awake_nodes.hpp"
#include "core/nodes/fused_blocks.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

namespace {

std::vector<Flag> fixed_nodes(const Model& m, const State& s) {
  const auto support = on_host(m.support);
  const auto component = on_host(m.support_component);
  const auto velocity = on_host(m.support_velocity), motion = on_host(s.nodes.motion);
  const auto is_fixed = [&](Index node) {
    const Index row = support[node];
    if (row < 0) return false;
    for (Index axis = 0; axis < 3; ++axis)
      if (!component[3 * row + axis] || velocity[3 * row + axis] != 0 ||
          motion[8 * std::size_t(node) + 4 + axis] != 0)
        return false;
    return true;
  };
  std::vector<Flag> fixed(m.node_count);
  for (Index i = 0; i < m.node_count; ++i) fixed[i] = is_fixed(i);
  return fixed;
}

/// Blocks with an averaged tet have kernels of their own, which run in every step.
void leave_averaged(const State& s, Column<Index>& awake) {
  const auto averaged = on_host(s.nodal.blocks);
  std::vector<Index> others = fetch(awake);
  std::erase_if(others, [&](Index block) {
    return std::binary_search(averaged.begin(), averaged.end(), block);
  });
  awake.assign(others);
}

/// Do elements of a tile share nodes?
bool is_joined(const ElementTiles& tiles, OnHost<const Index> element_first, Index tile) {
  const auto blocks = on_host(tiles.block_first), nodes = on_host(tiles.node_first);
  const auto node = on_host(tiles.node);
  for (Index k = nodes[blocks[tile]]; k < nodes[blocks[tile + 1]]; ++k)
    if (element_first[node[k] + 1] - element_first[node[k]] > 1) return true;
  return false;
}

/// A tile sums the forces of all its elements: if one moves, the others are awake, unless each has
/// nodes of its own.
void wake_tiles(const State& s, const ElementTiles& tiles, std::vector<Flag>& moves) {
  const auto element_first = on_host(s.nodes.element_first);
  const auto first = on_host(tiles.block_first);
  for (std::size_t tile = 0; tile + 1 < first.size(); ++tile) {
    const Index count = Index(moves.size()), last = first[tile + 1] * block_size;
    const auto begin = moves.begin() + first[tile] * block_size;
    const auto end = moves.begin() + std::min(last, count);
    if (std::find(begin, end, 1) != end && is_joined(tiles, element_first, Index(tile)))
      std::fill(begin, end, Flag(1));
  }
}

}  // namespace

void find_awake(const Model& m, State& s) {
  const Transfer transfer;
  const std::vector<Flag> fixed = fixed_nodes(m, s);
  std::vector<Flag> pulled(m.node_count);
  const Flag* const own_nodes = s.share.counted("nodes").own;
  const auto is_own = [own_nodes](Index node) { return !own_nodes || own_nodes[node]; };
  for_each_set(m, s, [&](const auto& kind, const auto& set, auto& state) {
    const auto for_each_node = nodes_of(m, set);
    std::vector<Flag> moves(set.count);
    const bool elements = requires { state.tiles; };
    const Counted own = s.share.counted(kind.name);
    for (Index i = 0; i < set.count; ++i) {
      // of elements at ghosts alone nothing is asked here; bonds there break here too
      const bool all = !elements || !own.own || own.own[i];
      for_each_node(i, [&](Index node) { moves[i] |= !fixed[node] && (all || is_own(node)); });
      if (moves[i]) for_each_node(i, [&](Index node) { pulled[node] = 1; });
    }
    if constexpr (requires { state.tiles; }) wake_tiles(s, state.tiles, moves);
    list_blocks(set.count, state.awake, [&](Index i) { return moves[i] != 0; });
  });
  leave_averaged(s, s.tet4.awake);
  s.nodes.sleeps.resize(m.node_count);
  const auto sleeps = on_host(s.nodes.sleeps);
  const NodePorts ports = on_host(node_ports(m, s));
  for (Index i = 0; i < m.node_count; ++i)
    sleeps[i] = !is_own(i) || (fixed[i] && !pulled[i] && !ports.is_loaded(i));
  list_awake_nodes(m, s);
}

void list_awake_nodes(const Model& m, State& s) {
  const Index blocks = m.node_count / block_size + (m.node_count % block_size > 0);
  Column<Flag> wakes;
  wakes.renew(m.node_count);
  s.nodes.listed.resize(m.node_count);
  for_each_item({}, m.node_count,
                FindWakingNodes{.own = s.share.counted("nodes").own,
                                .sleeps = s.nodes.sleeps.data(),
                                .contact_first = s.search.contact_first.data(),
                                .listed = s.nodes.listed.data(),
                                .wakes = wakes.data()});
  select_items({}, blocks,
               BlockIsAwake{.count = m.node_count,
                            .wakes = wakes.data(),
                            .lumped = m.lumped,
                            .mass_row_first = m.mass_row_first.data(),
                            .block_first = m.block_first.data(),
                            .block_count = m.block_count.data()},
               s.nodes.awake);
  find_fused_blocks(m, s);
}

}  // namespace cdem
