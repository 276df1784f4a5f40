// item_matrix.hpp - stiffness of one element, bonded pair or contact.
#pragma once

#include <algorithm>

#include "core/base/math.hpp"
#include "core/records/node_spring.hpp"

namespace cdem {

/// Symmetric matrix of an item over the displacements of its nodes  [N/m].
struct ItemMatrix {
  static constexpr Index most = NodeSpring::most;  // nodes

  Index count = 0;
  Index node[most];
  Real block[most][most][9];

  explicit ItemMatrix(Index nodes) : count(nodes) {
    for (Index a = 0; a < nodes; ++a) std::fill_n(block[a][0], 9 * nodes, 0.0);
  }
  explicit ItemMatrix(const NodeSpring& spring) : ItemMatrix(spring.count) {
    std::copy_n(spring.node, count, node);
    add_spring(spring.weight, spring.axis, spring.normal, spring.shear);
  }

  /// Add a spring with these stiffnesses between two points whose displacements are weighted means
  /// of those of the nodes: `weight` is that of the second less that of the first.
  void add_spring(const Real* weight, const Vec3<Real>& n, Real normal, Real shear) {
    const Real axis[3] = {n.x, n.y, n.z};
    for (Index a = 0; a < count; ++a)
      for (Index b = 0; b < count; ++b)
        for (Index i = 0; i < 3; ++i)
          for (Index j = 0; j < 3; ++j)
            block[a][b][3 * i + j] += weight[a] * weight[b] *
                                      ((i == j ? shear : 0) + (normal - shear) * axis[i] * axis[j]);
  }
};

}  // namespace cdem
