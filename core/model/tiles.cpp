// tiles.cpp - see tiles.hpp.
#include "core/model/tiles.hpp"

#include <vector>

#include "core/base/parallel.hpp"
#include "core/model/force_sets.hpp"
#include "core/records/tile_size.hpp"

namespace cdem {

namespace {

/// A tile ends where the nodes of another block of elements might be too many.
static_assert(most_tile_nodes >= 8 * block_size);
void divide(const Model& m, const ElementSet& e, ElementTiles& tiles) {
  std::vector<Index> block_first, node_first, node;
  tiles.place.resize(std::size_t(e.corners) * e.stride);
  const auto nodes = on_host(e.nodes);
  const auto places = on_host(tiles.place);
  std::vector<Index> place_of(m.node_count, -1);  // in the list of nodes
  Index first = 0;
  for (Index i = 0; i < e.count; ++i) {
    const Index size = Index(node.size());
    if (i % block_size == 0) {
      node_first.push_back(size);
      if (i == 0 || size - first + 8 * block_size > most_tile_nodes) {
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
  for_each_element_set(m, s, [&](auto, const ElementSet& e, ElementState& es) {
    divide(m, e, es.tiles);
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
}

}  // namespace cdem
