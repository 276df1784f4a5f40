// tangent.hpp - stiffness of the whole model where it is now: elements, and bonds that bear.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/rest/block_rows.hpp"

namespace cdem {

/// The tangent of all nodes, and which of their components may move.
struct Tangent {
  BlockRows matrix;          // 3 x 3 blocks; components that may not move have 1 on the diagonal
  std::vector<Flag> free;    // [node][3]
  std::vector<Index> point;  // [node] nodes that bonds hold in one place have one number
  Index points = 0;
};

/// Assemble it, on the host. Bodies that no support holds may not move: they have no equilibrium
/// of their own.
Tangent tangent_of(const Model& model, State& state);

}  // namespace cdem
