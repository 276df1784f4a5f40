// node_system.hpp - a linear system over the displacements of nodes.
#pragma once

#include <vector>

#include "core/base/math.hpp"
#include "core/rest/block_rows.hpp"

namespace cdem {

/// A symmetric matrix over the displacements of nodes, and what its coarser spaces are made of.
struct NodeSystem {
  BlockRows matrix;                // 3 x 3 blocks; 1 on the diagonal of what may not move
  std::vector<Index> group_first;  // [group + 1] consecutive nodes that are smoothed together
  std::vector<Index> point;        // [node] nodes that move together on the next level
  Index points = 0;                // how many different ones there are
  std::vector<Vec3<Real>> place;   // [node]  [m]
  std::vector<Flag> free;          // [node][3] may the component move?
};

}  // namespace cdem
