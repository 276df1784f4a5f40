// tiles.hpp - elements in tiles: each sums the forces on its nodes before the nodes sum them.
#pragma once

#include "core/base/parallel.hpp"
#include "core/elements/shapes.hpp"

namespace cdem {

/// Tiles of the elements of a set.
struct Tiles {
  Index count;
  const Index* block_first;            // [tile + 1] blocks of elements
  const Index* node_first;             // [block + 1] nodes that come to the tile with a block
  const Index *node, *row;             // these nodes, and their rows
  InIndices place;                     // [corner][element] of its node among the tile's nodes
  const Index *corner_first, *corner;  // of a GPU: see ElementTiles
  const Real* motion;                  // [node] rows of 8
  Real* force;                         // [row] rows of 4  [N]
};

/// Motion of the nodes of a tile, and the forces of its elements on them: small enough to stay in
/// the first cache.
struct TileNodes {
  const Tiles& tiles;
  Index first;   // of the tile's nodes in the lists of `tiles`
  Real* motion;  // [place] rows of 8
  Real* force;   // [place] rows of 4  [N]

  /// Take the motion of a node of the list.
  CDEM_HD void take(Index k) const {
    const Real* from = tiles.motion + std::size_t(tiles.node[k]) * 8;
    Real* to = motion + 8 * (k - first);
    Row::at(from).store(to);
    Row::at(from + 4).store(to + 4);
  }
  /// Put a force into the row of a node.
  CDEM_HD void give(Index k, const Vec3<Real>& f) const {
    Row::of(f.x, f.y, f.z).store(tiles.force + std::size_t(tiles.row[k]) * 4);
  }
  /// Take a node of the list in; without force yet.
  CDEM_HD void begin(Index k) const {
    take(k);
    Row::zero().store(force + 4 * (k - first));
  }
  /// Put the force on it into its row.
  CDEM_HD void end(Index k) const {
    Row::at(force + 4 * (k - first)).store(tiles.force + std::size_t(tiles.row[k]) * 4);
  }
  /// Add the forces of elements, in their order: the sum does not depend on the number of lanes.
  template <class I, class Shape>
  CDEM_HD void add(I e, const CornerForces<Shape, Number<I>>& forces) const {
    alignas(64) Real rows[4 * Shape::nodes * (sizeof(Number<I>) / sizeof(Real))];
    forces.store(OutForces{rows}, I{0});
    for_lanes(e, [&](Index lane, Index element) {
      const Real* of_corner = rows + 4 * Shape::nodes * lane;
      for (Index k = 0; k < Shape::nodes; ++k, of_corner += 4) {
        Real* sum = force + std::size_t(tiles.place.at(k, One{element})) * 4;
        (Row::at(sum) + Row::at(of_corner)).store(sum);
      }
    });
  }
};

/// Sum the forces of some blocks of elements in their tiles; blocks of a tile must be complete,
/// except for
/// elements that share no node with others. `Kernel::forces` computes them, for an element with
/// nodes in its tile. Instantiated for every kernel in core/kernels.
template <class Kernel>
void for_each_tile(Queue queue, Index count, Blocks blocks, const Tiles& tiles,
                   const Kernel& kernel);

}  // namespace cdem
