// tiles.cpp - see tiles.hpp.
#include "core/model/tiles.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/model/force_sets.hpp"
#include "core/records/tile_size.hpp"

namespace cdem {

namespace {

/// Call act(node of a tile, number) for the corners of all elements, tile by tile.
template <class Act>
void visit_corners(const ElementSet& e, const ElementTiles& tiles, const Act& act) {
  const auto block_first = on_host(tiles.block_first), node_first = on_host(tiles.node_first);
  const auto places = on_host(tiles.place);
  for (std::size_t tile = 0; tile + 1 < block_first.size(); ++tile) {
    const Index first = block_first[tile] * block_size, node = node_first[block_first[tile]];
    const Index last = std::min(block_first[tile + 1] * block_size, e.count);
    for (Index i = first; i < last; ++i)
      for (Index k = 0; k < e.corners; ++k)
        act(node + places[std::size_t(k) * e.stride + i], (i - first) * e.corners + k);
  }
}

/// A tile ends where the nodes of another block of elements might be too many; a rank has the
/// tiles of the whole model, `given` by block of elements, for sums on nodes go tile by tile.
static_assert(most_tile_nodes >= 8 * block_size);
void divide(const Model& m, const ElementSet& e, const Column<Index>* given, ElementTiles& tiles) {
  std::vector<Index> block_first, node_first, node;
  tiles.place.resize(std::size_t(e.corners) * e.stride);
  const auto nodes = on_host(e.nodes);
  const auto places = on_host(tiles.place);
  const Index* const tile_of = given ? on_host(*given).data() : nullptr;
  const auto begins = [&](Index block, Index nodes_so_far) {
    if (block == 0) return true;
    if (given) return tile_of[block] != tile_of[block - 1];
    return nodes_so_far + 8 * block_size > most_tile_nodes;
  };
  std::vector<Index> place_of(m.node_count, -1);  // in the list of nodes
  Index first = 0;
  for (Index i = 0; i < e.count; ++i) {
    const Index size = Index(node.size());
    if (i % block_size == 0) {
      node_first.push_back(size);
      if (begins(i / block_size, size - first)) {
        block_first.push_back(i / block_size);
        first = size;
      }
    }
    for (Index k = 0; k < e.corners; ++k) {
      const std::size_t corner = std::size_t(k) * e.stride + i;
      Index& place = place_of[nodes[corner]];
      if (place < first) {
        place = Index(node.size());
        node.push_back(nodes[corner]);
      }
      places[corner] = place - first;
    }
  }
  block_first.push_back(Blocks{}.count_in(e.count));
  node_first.push_back(Index(node.size()));
  tiles.block_first.assign(block_first);
  tiles.node_first.assign(node_first);
  tiles.node.assign(node);
}

}  // namespace

void list_tiles(const Model& m, State& s) {
  std::vector<Index> first(m.node_count + 1);
  for_each_element_set(m, s, [&](const auto& kind, const ElementSet& e, ElementState& es) {
    const auto given = s.share.tiles.find(kind.name);
    divide(m, e, given != s.share.tiles.end() ? &given->second : nullptr, es.tiles);
    for (const Index node : on_host(es.tiles.node)) ++first[node + 1];
  });
  for (Index i = 0; i < m.node_count; ++i) first[i + 1] += first[i];
  s.nodes.tile_first.assign(first);
  s.tile_force.resize(4 * std::size_t(first[m.node_count]));
  for_each_element_set(m, s, [&](auto, const ElementSet&, ElementState& es) {
    es.tiles.row.resize(es.tiles.node.size());
    Index* row = on_host(es.tiles.row).data();
    for (const Index node : on_host(es.tiles.node)) *row++ = first[node]++;
  });
  if (on_gpu) list_tile_corners(m, s);
}

void list_tile_corners(const Model& m, State& s) {
  for_each_element_set(m, s, [&](auto, const ElementSet& e, ElementState& es) {
    std::vector<Index> first(es.tiles.node.size() + 1), corner(std::size_t(e.corners) * e.count);
    visit_corners(e, es.tiles, [&](Index node, Index) { ++first[node + 1]; });
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<Index> next = first;
    visit_corners(e, es.tiles, [&](Index node, Index number) { corner[next[node]++] = number; });
    es.tiles.corner_first.assign(first);
    es.tiles.corner.assign(corner);
  });
}

}  // namespace cdem
