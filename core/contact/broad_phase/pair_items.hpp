// pair_items.hpp - parts of two patches that may touch: items of the passes of the search.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// A vertex of one patch of a pair, and a face of the other.
struct VertexFaceItem {
  Index pair;
  unsigned mothers : 8;           // faces at the vertex with a semi-spring that may touch, as bits
  unsigned of : 1;                // 0: the vertex is of the first patch, 1: of the second
  unsigned face : 3, vertex : 3;  // of the other patch, of this one

  bool operator==(const VertexFaceItem&) const = default;
};

/// An edge of the first patch of a pair, and one of the second.
struct EdgeItem {
  Index pair;
  unsigned ways : 8;            // in which they may touch, as bits, see EdgeWays
  unsigned one : 4, other : 4;  // of the first patch, of the second
  unsigned sides : 2;           // of each other on which they may touch, as bits, see TwoLines

  bool operator==(const EdgeItem&) const = default;
};

/// Copy a list.
template <class Item>
struct CopyItems {
  const Item* from;
  Item* to;
  CDEM_HD void operator()(One i) const { to[i.i] = from[i.i]; }
};

/// A vertex of a mother face on another exposed face, and the pair of vertex and face.
struct Candidate {
  Index slot, face, pair;
};

}  // namespace cdem
