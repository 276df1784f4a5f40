// corner_rows.hpp - the rows of forces that each node sums.
#pragma once

#include "core/base/views.hpp"

namespace cdem {

/// Which rows of forces belong to a node.
struct CornerLists {
  const Index* tile_first;  // [node + 1], rows of tiles of elements
  InForces tile_force;
  const Index* first;   // [node + 1], rows of bonded pairs and bolts
  const Index* corner;  // ~row where the node takes the opposite of what stands there
  InForces corner_force;
  const Index* contact_first;  // [node + 1], rows of exposed faces that may have contacts
  const Index* contact_corner;
  InForces contact_force;  // rows: force, stiffness

  /// Add a node's rows in the order of its lists: those of elements come first.
  CDEM_HD Row sum(Index node, Row f) const {
    for (Index t = tile_first[node]; t < tile_first[node + 1]; ++t) f = f + tile_force.at(t);
    for (Index c = first[node]; c < first[node + 1]; ++c)
      f = f + corner_force.signed_row(corner[c]);
    return f;
  }
};

}  // namespace cdem
