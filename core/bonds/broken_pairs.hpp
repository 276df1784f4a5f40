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

/// Has a broken pair moved by more than a part of its length? Of a pack: has any?
struct HasMovedFar {
  Real part;
  const Flag* status;
  InTable jump;  // [pair] of broken points  [m]
  PairLengths lengths;

  template <class I>
  CDEM_HD auto operator()(I item) const {
    using T = Number<I>;
    const T moved = jump.at(0, item);
    auto any = moved > T(0.0);
    if (!any_of(any)) return any;
    bool far = false;
    for_lanes(item,
              [&](Index lane, Index pair) { far = far || is_far(pair, of_lane(moved, lane)); });
    return T(far ? 1.0 : 0.0) > T(0.5);
  }

 private:
  CDEM_HD bool is_far(Index pair, Real moved) const {
    return is_live(PairStatus(status[pair])) && moved > 0 && moved > part * lengths.at(pair);
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
