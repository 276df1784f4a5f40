// Sums in tiles: the order is that of the elements, on any number of lanes and threads.
#include <vector>

#include "core/base/openmp.hpp"
#include "core/elements/tile_loops.hpp"
#include "core/model/tiles.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// The force on a corner is the position of its node times a number of the element.
struct Pull {
  using Shape = Tet4;
  ElementColumns<Tet4> columns;

  template <class I>
  CDEM_HD CornerForces<Tet4, Number<I>> forces(I e) const {
    CornerForces<Tet4, Number<I>> force;
    for (Index k = 0; k < 4; ++k)
      force.f[k] =
          columns.point_volume.at(0, e) * columns.nodes.position(columns.element_nodes.at(k, e));
    return force;
  }
};

/// Tets that join nodes at random, or each its own.
struct Web {
  Model model;
  State state;
  Column<Real> motion;

  explicit Web(Index count, bool joined = true) {
    Random random(3);
    ElementSet& e = model.tet4;
    model.node_count = joined ? 600 : 4 * count;
    e.count = count, e.stride = padded_stride(count), e.corners = 4;
    e.nodes.resize(4 * std::size_t(e.stride));
    e.volume.resize(e.stride);
    for (Index i = 0; i < count; ++i) {
      on_host(e.volume)[i] = std::pow(10, random.between(-8, 8));
      const Index first = random.below(150);
      for (Index k = 0; k < 4; ++k)
        on_host(e.nodes)[k * e.stride + i] =
            joined ? (first + 150 * k + i / 8) % model.node_count : 4 * i + k;
    }
    motion.resize(8 * std::size_t(model.node_count));
    for (Real& number : on_host(motion)) number = random.between(-1, 1);
    list_tiles(model, state);
  }
  Tiles tiles() {
    const ElementTiles& t = state.tet4.tiles;
    return {.count = Index(t.block_first.size()) - 1,
            .block_first = t.block_first.data(),
            .node_first = t.node_first.data(),
            .node = t.node.data(),
            .row = t.row.data(),
            .place = {t.place.data(), model.tet4.stride},
            .corner_first = t.corner_first.data(),
            .corner = t.corner.data(),
            .motion = motion.data(),
            .force = state.tile_force.data()};
  }
  void run(Blocks blocks) {
    Pull pull{};
    pull.columns.point_volume = {model.tet4.volume.data(), model.tet4.stride};
    for_each_tile({}, model.tet4.count, blocks, tiles(), pull);
  }
  /// The sums of one tile, element by element.
  std::vector<Real> expected(Index tile) const {
    const ElementSet& e = model.tet4;
    const ElementTiles& t = state.tet4.tiles;
    const Index begin = on_host(t.block_first)[tile], end = on_host(t.block_first)[tile + 1];
    std::vector<Real> sum(4 * (on_host(t.node_first)[end] - on_host(t.node_first)[begin]));
    const Index last = std::min(end * block_size, e.count);
    for (Index i = begin * block_size; i < last; ++i)
      for (Index k = 0; k < 4; ++k)
        for (Index axis = 0; axis < 3; ++axis)
          sum[4 * on_host(t.place)[k * e.stride + i] + axis] +=
              on_host(e.volume)[i] * on_host(motion)[8 * on_host(e.nodes)[k * e.stride + i] + axis];
    return sum;
  }
};

}  // namespace

TEST_CASE("tiles sum in the order of their elements, whatever the lanes and threads") {
  const int threads = omp_get_max_threads();
  for (const int on : {1, 3}) {
    omp_set_num_threads(on);
    for (const Index count : {1, lanes + 1, 2003}) {
      Web web(count);
      web.run({});
      const ElementTiles& t = web.state.tet4.tiles;
      Index differ = 0;
      for (Index tile = 0; tile + 1 < Index(t.block_first.size()); ++tile) {
        const std::vector<Real> sum = web.expected(tile);
        for (std::size_t k = 0; k < sum.size(); ++k) {
          const Index row =
              on_host(t.row)[on_host(t.node_first)[on_host(t.block_first)[tile]] + Index(k) / 4];
          differ += !same_bits(sum[k], on_host(web.state.tile_force)[4 * row + k % 4]);
        }
      }
      CHECK(differ == 0);
    }
  }
  omp_set_num_threads(threads);
}

TEST_CASE("tiles without a block on the list keep their rows") {
  Web web(2003);
  const ElementTiles& t = web.state.tet4.tiles;
  REQUIRE(t.block_first.size() > 4);
  std::vector<Index> list;  // of the second tile
  for (Index b = on_host(t.block_first)[1]; b < on_host(t.block_first)[2]; ++b) list.push_back(b);
  for (Real& number : on_host(web.state.tile_force)) number = 7;
  Column<Index> blocks;
  blocks.assign(list);
  web.run({blocks.data(), Index(blocks.size())});
  const std::vector<Real> sum = web.expected(1);
  for (Index k = 0; k < Index(t.node.size()); ++k) {
    const Index first = on_host(t.node_first)[list.front()],
                last = on_host(t.node_first)[list.back() + 1];
    const Real expected = k >= first && k < last ? sum[4 * (k - first)] : 7;
    CHECK(same_bits(on_host(web.state.tile_force)[4 * on_host(t.row)[k]], expected));
  }
}

TEST_CASE("blocks that share no node with others may be a part of a tile") {
  const Index count = 1003;
  Web web(count, false);
  std::vector<Index> list;
  for (Index b = 0; b <= count / block_size; ++b)
    if (b % 3 == 1 || b * block_size + block_size > count) list.push_back(b);
  for (Real& number : on_host(web.state.tile_force)) number = 7;
  Column<Index> blocks;
  blocks.assign(list);
  web.run({blocks.data(), Index(blocks.size())});
  const ElementTiles& t = web.state.tet4.tiles;
  const auto force = on_host(web.state.tile_force), motion = on_host(web.motion);
  for (Index k = 0; k < 4 * count; ++k) {  // nodes are numbered by their elements
    const bool runs = std::binary_search(list.begin(), list.end(), k / 4 / block_size);
    const Real expected = on_host(web.model.tet4.volume)[k / 4] * motion[8 * k];
    CHECK(same_bits(force[4 * on_host(t.row)[k]], runs ? 0 + expected : 7));
  }
}

}  // namespace cdem::test
