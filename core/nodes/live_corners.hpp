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

/// The live ones of the corner rows of a node.
struct LiveCorners {
  const Index *first, *corner;  // of all pairs and modules
  const Flag* live;

  template <class Act>
  CDEM_HD void visit(Index node, const Act& act) const {
    for (Index c = first[node]; c < first[node + 1]; ++c)
      if (live[corner[c] < 0 ? ~corner[c] : corner[c]]) act(corner[c]);
  }
};
struct CountLiveCorners {
  LiveCorners of;
  Index* count;
  CDEM_HD void operator()(One node) const {
    Index sum = 0;
    of.visit(node.i, [&](Index) { ++sum; });
    count[node.i] = sum;
  }
};
struct PutLiveCorners {
  LiveCorners of;
  const Index* first;
  Index* corner;
  CDEM_HD void operator()(One node) const {
    Index next = first[node.i];
    of.visit(node.i, [&](Index row) { corner[next++] = row; });
  }
};

}  // namespace cdem
