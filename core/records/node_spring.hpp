// node_spring.hpp - a spring of a module between nodes, for a solve.
#pragma once

#include "core/base/math.hpp"

namespace cdem {

/// A spring between two places, each a mean of nodes, as a solve for rest sees it.
struct NodeSpring {
  static constexpr Index most = 16;
  Index count = 0;
  Index node[most];
  Real weight[most];   // of the second place, less that of the first
  Vec3<Real> axis;     // of unit length
  Real normal, shear;  // along the axis, and across it  [N/m]
};

}  // namespace cdem
