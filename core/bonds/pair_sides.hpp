// pair_sides.hpp - the sides of listed pairs, by face.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// The two sides of listed pairs: side 2 k is the first face of pair k of the list, 2 k + 1 the
/// second. As a kernel of list_rows it brings them into rows by exposed face, so that all sides of
/// one face are dealt with by one thread, in the order of the pairs.
struct PairSides {
  const Index* pairs;
  const Index* pair_faces;    // [pair][2]
  const Index* face_exposed;  // place or -1

  CDEM_HD Index pair(Index side) const { return pairs[side / 2]; }
  /// The face of a side, and the other one of the pair.
  CDEM_HD Index face(Index side) const { return pair_faces[2 * pair(side) + side % 2]; }
  CDEM_HD Index other(Index side) const { return pair_faces[2 * pair(side) + 1 - side % 2]; }
  /// Their places.
  CDEM_HD Index exposed(Index side) const { return face_exposed[face(side)]; }
  CDEM_HD Index other_exposed(Index side) const { return face_exposed[other(side)]; }

  template <class Act>
  CDEM_HD void visit(One side, const Act& act) const {
    act(exposed(side.i), side.i);
  }
};

}  // namespace cdem
