// tile_loops.hpp - the loop behind for_each_tile. Only the files of core/kernels include it.
#pragma once

#include "core/base/parallel_loops.hpp"
#include "core/elements/tiles.hpp"
#include "core/records/tile_size.hpp"

namespace cdem {

/// The kernel for elements whose nodes are those of a tile.
template <class Kernel>
CDEM_HD inline Kernel in_tile(Kernel kernel, const TileNodes& nodes) {
  kernel.columns.nodes = {nodes.motion};
  kernel.columns.element_nodes = nodes.tiles.place;
  return kernel;
}

#if defined(CDEM_CUDA)

/// One thread block for each tile. Its threads compute elements side by side; three of them then
/// add the forces in the order of the elements, one for each axis.
inline constexpr Index tile_threads = 64;

template <class Kernel>
__global__ void run_tiles_on_gpu(Index count, Blocks blocks, Tiles tiles, Kernel kernel) {
  constexpr Index corners = Kernel::Shape::nodes;
  __shared__ Real motion[8 * most_tile_nodes], force[4 * most_tile_nodes];
  __shared__ Real rows[4 * corners * tile_threads];
  const Index tile = blockIdx.x, thread = threadIdx.x;
  const Range some = blocks.between(tiles.block_first[tile], tiles.block_first[tile + 1]);
  if (some.first == some.last) return;
  const Range all{tiles.node_first[tiles.block_first[tile]],
                  tiles.node_first[tiles.block_first[tile + 1]]};
  const TileNodes nodes{tiles, all.first, motion, force};
  for (Index k = all.first + thread; k < all.last; k += tile_threads) nodes.begin(k);
  const Kernel local = in_tile(kernel, nodes);
  const auto element = [&](Index b, Index j) {
    return b + j / block_size < some.last ? blocks.first(b + j / block_size) + j % block_size
                                          : count;
  };
  for (Index b = some.first; b < some.last; b += tile_threads / block_size) {
    __syncthreads();
    const Index own = element(b, thread);
    if (own < count) local.forces(One{own}).store(OutForces{rows}, One{thread});
    __syncthreads();
    for (Index j = 0; thread < 3 && j < tile_threads; ++j)
      for (Index k = 0; element(b, j) < count && k < corners; ++k)
        force[4 * tiles.place.at(k, One{element(b, j)}) + thread] +=
            rows[4 * (corners * j + k) + thread];
  }
  __syncthreads();
  for (Index k = all.first + thread; k < all.last; k += tile_threads) nodes.end(k);
}

template <class Kernel>
void for_each_tile(Queue queue, Index count, Blocks blocks, const Tiles& tiles,
                   const Kernel& kernel) {
  if (tiles.count == 0 || blocks.count_in(count) == 0) return;
  run_tiles_on_gpu<<<tiles.count, tile_threads, 0, static_cast<cudaStream_t>(queue.stream)>>>(
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
  launch(tiles.count, kernel, [&](const Kernel& own, Index tile) {
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
  const bool several = blocks.count_in(count) * block_size >= worth_threads;
#pragma omp parallel for schedule(static, run) if (several)
  for (Index tile = 0; tile < tiles.count; ++tile) {
    const Range some = blocks.between(tiles.block_first[tile], tiles.block_first[tile + 1]);
    if (some.first == some.last) continue;
    alignas(64) Real motion[8 * most_tile_nodes], force[4 * most_tile_nodes];
    const TileNodes nodes{tiles, tiles.node_first[tiles.block_first[tile]], motion, force};
    visit_nodes(tiles, blocks, some, [&](Index k) { nodes.begin(k); });
    run_blocks(count, blocks, some, nodes, in_tile(kernel, nodes));
    visit_nodes(tiles, blocks, some, [&](Index k) { nodes.end(k); });
  }
}

#endif

#endif

}  // namespace cdem
