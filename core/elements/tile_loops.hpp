// tile_loops.hpp - the loop behind for_each_tile. Only the files of core/kernels include it.
#pragma once

#include "core/base/parallel_loops.hpp"
#include "core/elements/tiles.hpp"
#include "core/records/tile_size.hpp"

namespace cdem {

/// The kernel for elements with nodes in a tile.
template <class Kernel>
CDEM_HD inline Kernel in_tile(Kernel kernel, const TileNodes& nodes) {
  kernel.columns.nodes = {nodes.motion};
  kernel.columns.element_nodes = nodes.tiles.place;
  return kernel;
}

#if defined(CDEM_CUDA)

/// Elements of a tile that are computed side by side, a thread each: their forces fit into shared
/// memory beside the motion of the nodes.
template <class Shape>
inline constexpr Index tile_window = Shape::nodes > 4 ? 128 : 256;

/// Forces of a window of elements on their corners, axis by axis.
template <class Shape>
struct WindowForces {
  static constexpr Index window = tile_window<Shape>;
  Real number[3][Shape::nodes][window];

  __device__ void put(Index thread, const CornerForces<Shape, Real>& forces) {
    for (Index k = 0; k < Shape::nodes; ++k) {
      number[0][k][thread] = forces.f[k].x;
      number[1][k][thread] = forces.f[k].y;
      number[2][k][thread] = forces.f[k].z;
    }
  }
  /// Of a corner, counted element by element from the first of the window.
  __device__ Vec3<Real> of(Index corner) const {
    const Index e = corner / Shape::nodes, k = corner % Shape::nodes;
    return {number[0][k][e], number[1][k][e], number[2][k][e]};
  }
};

inline constexpr Index no_corner = -1;

/// Take the motion of a tile's nodes, and the first corner of each: none of a node whose elements
/// are not to be run. The threads of a window share the work.
template <class Shape>
__device__ void begin_nodes(const TileNodes& nodes, Blocks blocks, Index first_block, Range all,
                            Index* next) {
  for (Index n = threadIdx.x; n < all.last - all.first; n += tile_window<Shape>) {
    nodes.take(all.first + n);
    const Index corner = nodes.tiles.corner_first[all.first + n];
    const Index block = first_block + nodes.tiles.corner[corner] / (Shape::nodes * block_size);
    next[n] = blocks.has(block) ? corner : no_corner;
  }
}

/// One thread block for each tile: a window of elements after the other, and after each of them
/// every node takes its forces, in the order of the elements.
template <class Kernel>
__global__ void __launch_bounds__(tile_window<typename Kernel::Shape>, 2)
    run_tiles_on_gpu(Index count, Blocks blocks, Tiles tiles, Kernel kernel) {
  using Shape = typename Kernel::Shape;
  constexpr Index corners = Shape::nodes, window = tile_window<Shape>;
  constexpr Index nodes_of_thread = (most_tile_nodes + window - 1) / window;
  __shared__ Real motion[8 * most_tile_nodes];
  __shared__ WindowForces<Shape> forces;
  __shared__ Index next[most_tile_nodes];  // corner of each node
  __shared__ Range own, all;  // blocks and nodes of the tile; in registers they would be too many
  const Index tile = blockIdx.x, thread = threadIdx.x;
  if (thread == 0) {
    own = {tiles.block_first[tile], tiles.block_first[tile + 1]};
    all = {tiles.node_first[own.first], tiles.node_first[own.last]};
  }
  __syncthreads();
  const Range some = blocks.between(own.first, own.last);
  if (some.first == some.last) return;
  const TileNodes nodes{tiles, all.first, motion, nullptr};
  begin_nodes<Shape>(nodes, blocks, own.first, all, next);
  const Kernel local = in_tile(kernel, nodes);
  Vec3<Real> sum[nodes_of_thread];
  for (Vec3<Real>& of_node : sum) of_node = {0.0, 0.0, 0.0};
  const auto for_own_nodes = [&](const auto& act) {
#pragma unroll
    for (Index k = 0; k < nodes_of_thread; ++k) {
      const Index n = thread + k * window;
      if (n < all.last - all.first && next[n] != no_corner) act(n, sum[k]);
    }
  };
  for (Index b = own.first; b < own.last; b += window / block_size) {
    const Index block = b + thread / block_size, e = b * block_size + thread;
    const bool runs = block < own.last && e < count && blocks.has(block);
    if (!__syncthreads_or(runs)) continue;
    if (runs) forces.put(thread, local.forces(One{e}));
    __syncthreads();
    const Index begin = (b - own.first) * block_size * corners, end = begin + window * corners;
    for_own_nodes([&](Index n, Vec3<Real>& of_node) {
      Index c = next[n];
      const Index last = tiles.corner_first[all.first + n + 1];
      for (; c < last && tiles.corner[c] < end; ++c)
        of_node = of_node + forces.of(tiles.corner[c] - begin);
      next[n] = c;
    });
  }
  for_own_nodes([&](Index n, Vec3<Real>& of_node) { nodes.give(all.first + n, of_node); });
}

template <class Kernel>
void for_each_tile(Queue queue, Index count, Blocks blocks, const Tiles& tiles,
                   const Kernel& kernel) {
  if (tiles.count == 0 || blocks.count_in(count) == 0) return;
  constexpr Index threads = tile_window<typename Kernel::Shape>;
  run_tiles_on_gpu<<<tiles.count, threads, 0, static_cast<cudaStream_t>(queue.stream)>>>(
      count, blocks, tiles, kernel);
  check(cudaGetLastError());
}

#else

/// Call act(k) for the nodes that come with some blocks of a tile, run by run of these.
template <class Act>
void visit_nodes(const Tiles& tiles, Blocks blocks, Range some, const Act& act) {
  for (Index b = some.first; b < some.last;) {
    const Index first = blocks.first(b) / block_size;
    Index last = first;
    for (; b < some.last && blocks.first(b) / block_size == last; ++b) ++last;
    for (Index k = tiles.node_first[first]; k < tiles.node_first[last]; ++k) act(k);
  }
}

#if defined(CDEM_EMULATED)

/// A tile is an item: its threads wait for each other.
template <class Kernel>
void for_each_tile(Queue, Index count, Blocks blocks, const Tiles& tiles, const Kernel& kernel) {
  launch(tiles.count, kernel, [=](const Kernel& own, Index tile) {
    const Range some = blocks.between(tiles.block_first[tile], tiles.block_first[tile + 1]);
    if (some.first == some.last) return;
    alignas(64) Real motion[8 * most_tile_nodes], force[4 * most_tile_nodes];
    const TileNodes nodes{tiles, tiles.node_first[tiles.block_first[tile]], motion, force};
    visit_nodes(tiles, blocks, some, [&](Index k) { nodes.begin(k); });
    const Kernel local = in_tile(own, nodes);
    for (Index b = some.first; b < some.last; ++b)
      for (Index i = blocks.first(b); i < blocks.first(b) + block_size && i < count; ++i)
        nodes.add(One{i}, local.forces(One{i}));
    visit_nodes(tiles, blocks, some, [&](Index k) { nodes.end(k); });
  });
}

#else

/// The same as in parallel_loops.hpp.
template <class Kernel>
[[gnu::cold, gnu::noinline]] void run_one(TileNodes nodes, Kernel kernel, Index i) {
  nodes.add(One{i}, kernel.forces(One{i}));
}

/// Blocks of one tile, lane by lane.
template <class Kernel>
void run_blocks(Index count, Blocks blocks, Range some, const TileNodes& nodes,
                const Kernel& kernel) {
  const Index whole = count - count % lanes;
  for (Index b = some.first; b < some.last; ++b) {
    const Index first = blocks.first(b);
    const Index last = first + block_size < count ? first + block_size : count;
    fetch_ahead(kernel, blocks, b);
    Index i = first;
    for (; i < last && i < whole; i += lanes) nodes.add(Lane{i}, kernel.forces(Lane{i}));
    for (; i < last; ++i) run_one(nodes, kernel, i);
  }
}

/// Tiles are dealt to the threads in short runs: neighbours share nodes, and those that have
/// nothing to do may lie together.
template <class Kernel>
void for_each_tile(Queue, Index count, Blocks blocks, const Tiles& tiles, const Kernel& kernel) {
  const Index run = tiles.count / 64 + 1;
  const Index points = blocks.count_in(count) * block_size * Kernel::Shape::points;
  const bool several = points >= worth_threads;
  const auto run_tile = [&](Index tile) {
    const Range some = blocks.between(tiles.block_first[tile], tiles.block_first[tile + 1]);
    if (some.first == some.last) return;
    alignas(64) Real motion[8 * most_tile_nodes], force[4 * most_tile_nodes];
    const TileNodes nodes{tiles, tiles.node_first[tiles.block_first[tile]], motion, force};
    visit_nodes(tiles, blocks, some, [&](Index k) { nodes.begin(k); });
    run_blocks(count, blocks, some, nodes, in_tile(kernel, nodes));
    visit_nodes(tiles, blocks, some, [&](Index k) { nodes.end(k); });
  };
  on_threads(several, [&](Thread thread) {
    thread.deal(tiles.count, run, [&](Index first, Index last) {
      for (Index tile = first; tile < last; ++tile) run_tile(tile);
    });
  });
}

#endif

#endif

}  // namespace cdem
