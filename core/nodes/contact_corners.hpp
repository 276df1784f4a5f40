// contact_corners.hpp - corner rows of contact forces by the node that sums them.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// The vertices of an exposed face that is listed, see list_rows: their nodes, and their rows.
struct ContactCorners {
  const Index* exposed_face;
  const Index* face_nodes;
  const Flag* listed;  // [exposed]

  template <class Do>
  CDEM_HD void visit(One x, const Do& act) const {
    if (!listed[x.i]) return;
    const Index* nodes = face_nodes + 4 * std::size_t(exposed_face[x.i]);
    for (Index k = 0; k < 4; ++k)
      if (nodes[k] >= 0) act(nodes[k], 4 * x.i + k);
  }
};

}  // namespace cdem
