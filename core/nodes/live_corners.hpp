// live_corners.hpp - kernels that list the corner rows which nodes sum.
#pragma once

#include "core/base/lanes.hpp"
#include "core/records/pair_status.hpp"

namespace cdem {

/// Flag the corner rows of live pairs of a set.
struct MarkLiveRows {
  const Flag* status;    // [pair]
  Index first, corners;  // rows of the set, and of a pair
  Flag* live;            // [row]

  CDEM_HD void operator()(One pair) const {
    const Flag is = is_live(PairStatus(status[pair.i]));
    for (Index k = 0; k < corners; ++k) live[first + pair.i * corners + k] = is;
  }
};

/// The live ones of the corner rows of a node, see list_items.
struct LiveCorners {
  const Index *first, *corner;  // of all pairs and modules
  const Flag* live;

  template <class Act>
  CDEM_HD void visit(One node, const Act& act) const {
    for (Index c = first[node.i]; c < first[node.i + 1]; ++c)
      if (live[corner[c] < 0 ? ~corner[c] : corner[c]]) act(corner[c]);
  }
};

}  // namespace cdem
