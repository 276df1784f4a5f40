// lets_go.hpp - which bonded pairs are to be released, and which have become hinges.
#pragma once

#include "core/base/math.hpp"
#include "core/records/pair_status.hpp"

namespace cdem {

/// Has a broken pair moved by more than a part of its length?
struct LetsGo {
  Real part;
  const Flag* status;
  const Real* jump;    // [pair] of what is broken  [m]
  const Index* faces;  // [pair][2]
  const Real* face_length;

  CDEM_HD bool operator()(One pair) const {
    const Real way = jump[pair.i];
    if (!is_live(PairStatus(status[pair.i])) || !(way > 0)) return false;
    const Real length = min_of(face_length[faces[2 * pair.i + 1]], face_length[faces[2 * pair.i]]);
    return way > part * length;
  }
};

/// Is a pair bonded by some of its points, and not by others?
struct HoldsInPart {
  const Flag* status;
  const Real* bond;          // [point]
  const Index* point_first;  // overlaps: [pair + 1]; else null
  Index points, stride;      // of conforming pairs: [point][pair]

  CDEM_HD bool operator()(One pair) const {
    const Index first = point_first ? point_first[pair.i] : pair.i;
    const Index count = point_first ? point_first[pair.i + 1] - first : points;
    const std::size_t next = point_first ? 1 : stride;
    Index holding = 0;
    for (Index k = 0; k < count; ++k) holding += bond[first + k * next] > 0;
    return PairStatus(status[pair.i]) == PairStatus::bonded && holding > 0 && holding < count;
  }
};

}  // namespace cdem
