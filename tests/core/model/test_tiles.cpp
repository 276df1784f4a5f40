// Elements divided into tiles, and the rows that each node sums.
#include <algorithm>
#include <set>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/model/force_sets.hpp"
#include "core/model/tiles.hpp"
#include "core/records/tile_size.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// A grid of n^3 hexahedra, and tets with nodes of their own and of the grid.
struct Grid {
  Model model;
  State state;

  explicit Grid(Index n) {
    const Index side[3] = {1, n + 1, (n + 1) * (n + 1)};
    model.node_count = (n + 1) * side[2] + 200;
    std::vector<std::vector<Index>> cells, tets;
    for (Index z = 0; z < n; ++z)
      for (Index y = 0; y < n; ++y)
        for (Index x = 0; x < n; ++x) {
          const Index a = x + y * side[1] + z * side[2];
          cells.push_back({a, a + 1, a + side[1] + 1, a + side[1]});
          for (Index k = 0; k < 4; ++k) cells.back().push_back(cells.back()[k] + side[2]);
        }
    for (Index i = 0; i < 99; ++i)
      tets.push_back({(n + 1) * side[2] + i, (n + 1) * side[2] + i + 100, i, i + 1});
    fill(model.hex8, 8, cells);
    fill(model.tet4, 4, tets);
    list_tiles(model, state);
  }

 private:
  static void fill(ElementSet& e, Index corners, const std::vector<std::vector<Index>>& nodes) {
    e.count = Index(nodes.size()), e.stride = padded_stride(e.count), e.corners = corners;
    e.nodes.resize(std::size_t(corners) * e.stride);
    for (Index i = 0; i < e.count; ++i)
      for (Index k = 0; k < corners; ++k)
        on_host(e.nodes)[std::size_t(k) * e.stride + i] = nodes[i][k];
  }
};

}  // namespace

TEST_CASE("tiles are blocks one after the other, and each lists its nodes once") {
  Grid grid(14);
  CHECK(grid.state.hex8.tiles.block_first.size() > 5);
  for_each_element_set(
      grid.model, grid.state, [&](auto, const ElementSet& e, const ElementState& es) {
        const ElementTiles& t = es.tiles;
        const Index count = Index(t.block_first.size()) - 1;
        CHECK(on_host(t.block_first)[0] == 0);
        CHECK(on_host(t.block_first)[count] == Blocks{}.count_in(e.count));
        for (Index tile = 0; tile < count; ++tile) {
          CHECK(on_host(t.block_first)[tile] < on_host(t.block_first)[tile + 1]);
          const Index first = on_host(t.node_first)[on_host(t.block_first)[tile]];
          const Index nodes = on_host(t.node_first)[on_host(t.block_first)[tile + 1]] - first;
          CHECK(nodes <= most_tile_nodes);
          std::set<Index> named(t.node.data() + first, t.node.data() + first + nodes), used;
          CHECK(Index(named.size()) == nodes);
          const Index last = std::min(on_host(t.block_first)[tile + 1] * block_size, e.count);
          for (Index i = on_host(t.block_first)[tile] * block_size; i < last; ++i)
            for (Index k = 0; k < e.corners; ++k) {
              const std::size_t at = std::size_t(k) * e.stride + i;
              CHECK(on_host(t.node)[first + on_host(t.place)[at]] == on_host(e.nodes)[at]);
              used.insert(on_host(e.nodes)[at]);
            }
          CHECK(used == named);
        }
      });
}

TEST_CASE("the corners at a node of a tile are listed by element") {
  Grid grid(14);
  list_tile_corners(grid.model, grid.state);
  for_each_element_set(
      grid.model, grid.state, [&](auto, const ElementSet& e, const ElementState& es) {
        const ElementTiles& t = es.tiles;
        const auto first = on_host(t.corner_first), corner = on_host(t.corner);
        REQUIRE(first.size() == t.node.size() + 1);
        CHECK(first[t.node.size()] == e.corners * e.count);
        for (std::size_t tile = 0; tile + 1 < t.block_first.size(); ++tile) {
          const Index block = on_host(t.block_first)[tile];
          const Index begin = on_host(t.node_first)[block];
          const Index end = on_host(t.node_first)[on_host(t.block_first)[tile + 1]];
          for (Index k = begin; k < end; ++k) {
            CHECK(first[k] < first[k + 1]);
            for (Index c = first[k]; c < first[k + 1]; ++c) {
              if (c > first[k]) CHECK(corner[c - 1] < corner[c]);
              const Index i = block * block_size + corner[c] / e.corners;
              CHECK(on_host(t.place)[corner[c] % e.corners * e.stride + i] == k - begin);
            }
          }
        }
      });
}

TEST_CASE("rows of a node lie together, in the order of sets and tiles, each of one tile") {
  Grid grid(14);
  const State& s = grid.state;
  Index most = 0;
  std::vector<Index> next(s.nodes.tile_first.data(),
                          s.nodes.tile_first.data() + grid.model.node_count);
  for_each_element_set(grid.model, grid.state,
                       [&](auto, const ElementSet&, const ElementState& es) {
                         for (std::size_t k = 0; k < es.tiles.node.size(); ++k)
                           CHECK(on_host(es.tiles.row)[k] == next[on_host(es.tiles.node)[k]]++);
                       });
  for (Index i = 0; i < grid.model.node_count; ++i) {
    CHECK(next[i] == on_host(s.nodes.tile_first)[i + 1]);
    most = std::max(most, next[i] - on_host(s.nodes.tile_first)[i]);
  }
  CHECK(most > 2);
  CHECK(s.tile_force.size() == 4 * std::size_t(on_host(s.nodes.tile_first)[grid.model.node_count]));
}

}  // namespace cdem::test
