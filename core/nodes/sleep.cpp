// sleep.cpp - see sleep.hpp.
#include "core/nodes/sleep.hpp"

#include <algorithm>
#include <vector>

#include "core/model/block_lists.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/fused_blocks.hpp"

namespace cdem {

namespace {

bool is_fixed(const Model& m, const State& s, Index node) {
  const Index row = m.support[node];
  if (row < 0) return false;
  for (Index axis = 0; axis < 3; ++axis)
    if (!m.support_component[3 * row + axis] || m.support_velocity[3 * row + axis] != 0 ||
        s.nodes.motion[8 * std::size_t(node) + 4 + axis] != 0)
      return false;
  return true;
}

/// Blocks of tets of which one is averaged have kernels of their own, which run in every step.
void leave_averaged(const State& s, Column<Index>& awake) {
  const Column<Index>& averaged = s.nodal.blocks;
  std::size_t kept = 0;
  for (const Index block : std::vector<Index>(awake.data(), awake.data() + awake.size()))
    if (!std::binary_search(averaged.data(), averaged.data() + averaged.size(), block))
      awake[kept++] = block;
  awake.resize(kept);
}

/// A tile sums the forces of all its elements: if one moves, the others are awake.
void wake_tiles(const ElementTiles& tiles, std::vector<Flag>& moves) {
  for (std::size_t tile = 0; tile + 1 < tiles.block_first.size(); ++tile) {
    const Index count = Index(moves.size()), last = tiles.block_first[tile + 1] * block_size;
    const auto begin = moves.begin() + tiles.block_first[tile] * block_size;
    const auto end = moves.begin() + std::min(last, count);
    if (std::find(begin, end, 1) != end) std::fill(begin, end, Flag(1));
  }
}

}  // namespace

void find_awake(const Model& m, State& s) {
  const Transfer transfer;
  std::vector<Flag> fixed(m.node_count), pulled(m.node_count);
  for (Index i = 0; i < m.node_count; ++i) fixed[i] = is_fixed(m, s, i);
  for_each_set(m, s, [&](auto, const auto& set, auto& state) {
    std::vector<Flag> moves(set.count);
    for (Index i = 0; i < set.count; ++i) {
      for_each_node(m, set, i, [&](Index node) { moves[i] |= !fixed[node]; });
      if (moves[i]) for_each_node(m, set, i, [&](Index node) { pulled[node] = 1; });
    }
    if constexpr (requires { state.tiles; }) wake_tiles(state.tiles, moves);
    list_blocks(set.count, state.awake, [&](Index i) { return moves[i] != 0; });
  });
  leave_averaged(s, s.tet4.awake);
  s.nodes.sleeps.resize(m.node_count);
  for (Index i = 0; i < m.node_count; ++i)
    s.nodes.sleeps[i] = fixed[i] && !pulled[i] && m.load_first[i] == m.load_first[i + 1];
  list_awake_nodes(m, s);
}

void list_awake_nodes(const Model& m, State& s) {
  s.nodes.listed.resize(m.node_count);
  const Index* first = s.search.contact_first.data();
  std::vector<Flag> wakes(m.node_count);
  for (Index i = 0; i < m.node_count; ++i) {
    const bool was = s.nodes.listed[i], is = first[i] < first[i + 1];
    s.nodes.listed[i] = is;
    wakes[i] = !s.nodes.sleeps[i] || is || was;
  }
  for (Index i = 0; i < m.node_count; ++i) {  // nodes that share a mass matrix move together
    if (m.lumped || m.mass_row_first[i] < 0 || m.block_first[i] != i) continue;
    const auto begin = wakes.begin() + i, end = begin + m.block_count[i];
    if (std::any_of(begin, end, [](Flag f) { return f; })) std::fill(begin, end, Flag(1));
  }
  list_blocks(m.node_count, s.nodes.awake, [&](Index i) { return wakes[i]; });
  find_fused_blocks(m, s);
}

}  // namespace cdem
