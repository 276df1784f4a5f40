// module_ports.hpp - how, and when in a step, a module acts on nodes.
#pragma once

#include "core/base/math.hpp"

namespace cdem {

/// A dashpot between a node and the ground: its symmetric matrix, xx yy zz xy yz zx  [kg/s].
struct NodeDashpot {
  Index node;
  Real matrix[6];
};

/// A spring between two places, each a mean of nodes, as a solve for rest sees it.
struct NodeSpring {
  static constexpr Index most = 16;
  Index count = 0;
  Index node[most];
  Real weight[most];   // of the second place, less that of the first
  Vec3<Real> axis;     // of unit length
  Real normal, shear;  // along the axis, and across it  [N/m]
};

/// How the forces of a module come to nodes.
enum class Port {
  rows,     // between nodes: each adds rows of its items, after elements and before contacts
  applied,  // from outside: one sum for each node, after other loads
};
/// When in a step a module acts.
enum class Stage { before_contacts, after_contacts };

}  // namespace cdem
