// broken_pairs.hpp - which broken pairs have moved, and which pairs are bonded in part.
#pragma once

#include "core/base/views.hpp"
#include "core/records/pair_status.hpp"

namespace cdem {

/// Smaller length L of the two faces of pairs  [m].
struct PairLengths {
  const Index* faces;  // [pair][2]
  const Real* face_length;

  CDEM_HD Real at(Index pair) const {
    return min_of(face_length[faces[2 * pair + 1]], face_length[faces[2 * pair]]);
  }
};

/// Has a pair moved since it broke?
struct HasJumped {
  InTable jump;  // [pair] of broken points  [m]
  template <class I>
  CDEM_HD auto operator()(I item) const {
    return jump.at(0, item) > Number<I>(0.0);
  }
};

/// Has a broken pair moved by more than a part of its length?
struct HasMovedFar {
  Real part;
  const Flag* status;
  InTable jump;  // [pair] of broken points  [m]
  PairLengths lengths;

  CDEM_HD bool operator()(One pair) const {
    const Real moved = jump.at(0, pair);
    return is_live(PairStatus(status[pair.i])) && moved > 0 && moved > part * lengths.at(pair.i);
  }
  /// See raise_if_any.
  HasJumped quicker() const { return {jump}; }
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
