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
  for (Column<Index>* list : {&tiles.block_first, &tiles.node_first, &tiles.node}) list->resize(0);
  tiles.place.resize(std::size_t(e.corners) * e.stride);
  std::vector<Index> place_of(m.node_count, -1);  // in the list of nodes
  Index first = 0;
  for (Index i = 0; i < e.count; ++i) {
    const Index size = Index(tiles.node.size());
    if (i % block_size == 0) {
      tiles.node_first.push(size);
      if (i == 0 || size - first + 8 * block_size > most_tile_nodes) {
        tiles.block_first.push(i / block_size);
        first = size;
      }
    }
    for (Index k = 0; k < e.corners; ++k) {
      const std::size_t corner = std::size_t(k) * e.stride + i;
      Index& place = place_of[e.nodes[corner]];
      if (place < first) {
        place = Index(tiles.node.size());
        tiles.node.push(e.nodes[corner]);
      }
      tiles.place[corner] = place - first;
    }
  }
  tiles.block_first.push(Blocks{}.count_in(e.count));
  tiles.node_first.push(Index(tiles.node.size()));
}

}  // namespace

void list_tiles(const Model& m, State& s) {
  Column<Index>& first = s.nodes.tile_first;
  first.resize(m.node_count + 1);
  first.fill(0);
  for_each_element_set(m, s, [&](auto, const ElementSet& e, ElementState& es) {
    divide(m, e, es.tiles);
    for (std::size_t k = 0; k < es.tiles.node.size(); ++k) ++first[es.tiles.node[k] + 1];
  });
  for (Index i = 0; i < m.node_count; ++i) first[i + 1] += first[i];
  std::vector<Index> next(first.data(), first.data() + m.node_count);
  for_each_element_set(m, s, [&](auto, const ElementSet&, ElementState& es) {
    es.tiles.row.resize(es.tiles.node.size());
    for (std::size_t k = 0; k < es.tiles.node.size(); ++k)
      es.tiles.row[k] = next[es.tiles.node[k]]++;
  });
  s.tile_force.resize(4 * std::size_t(first[m.node_count]));
}

}  // namespace cdem
