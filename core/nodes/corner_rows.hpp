// corner_rows.hpp - the rows of forces that each node sums.
#pragma once

#include "core/base/views.hpp"

namespace cdem {

/// Which corner rows belong to a node.
struct CornerLists {
  const Index* first;   // [node + 1], rows of elements and bonded pairs
  const Index* corner;  // ~row where the node takes the opposite of what stands there
  InForces corner_force;
  const Index* contact_first;  // [node + 1], rows of exposed faces that may have contacts
  const Index* contact_corner;
  InForces contact_force;  // rows: force, stiffness

  /// Sum of a node's rows, in the order of its list: those of elements come first, and have no
  /// sign.
  CDEM_HD Row sum(Index node, Row f) const {
    Index c = first[node];
    const Index last = first[node + 1];
    for (; c < last && corner[c] >= 0; ++c) f = f + corner_force.at(corner[c]);
    for (; c < last; ++c) f = f + corner_force.signed_row(corner[c]);
    return f;
  }
};

}  // namespace cdem
