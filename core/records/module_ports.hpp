// module_ports.hpp - how, and when in a step, a module acts on nodes.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// A dashpot between a node and the ground: its symmetric matrix, xx yy zz xy yz zx  [kg/s].
struct NodeDashpot {
  Index node;
  Real matrix[6];
};

/// How the forces of a module come to nodes.
enum class Port {
  rows,     // between nodes: each adds rows of its items, after elements and before contacts
  applied,  // from outside: one sum for each node, after other loads
};
/// When in a step a module acts.
enum class Stage { before_contacts, after_contacts };

}  // namespace cdem
