// renewed_faces.hpp - kernels that bring rows of exposed faces to their new places.
#pragma once

#include <type_traits>

#include "core/base/lanes.hpp"
#include "core/base/parallel.hpp"

namespace cdem {

/// Do flags of exposed faces differ from where the faces are?
struct OpensOrLeaves {
  const Flag* open;
  const Index* place;  // [face] among the exposed ones, or -1
  CDEM_HD bool operator()(One face) const { return (open[face.i] != 0) != (place[face.i] >= 0); }
};
/// Flags of exposed faces, from their places.
struct FlagExposed {
  const Index* place;
  Flag* open;
  CDEM_HD void operator()(One face) const { open[face.i] = place[face.i] >= 0; }
};
/// Flag the two faces of listed pairs.
struct MarkFacesOfPairs {
  const Index *pairs, *faces;
  Flag* open;
  CDEM_HD void operator()(One item) const {
    for (Index side = 0; side < 2; ++side) set(open[faces[2 * pairs[item.i] + side]]);
  }
};

/// Old and new places of exposed faces; item: new place.
struct PairPlaces {
  const Index *face, *place;  // [new place]; [face] old place, or -1
  Index *before, *to;         // [new place] old one; [old place] new one; -1: none
  CDEM_HD void operator()(One x) const {
    const Index old = before[x.i] = place[face[x.i]];
    if (old >= 0) to[old] = x.i;
  }
};
/// Faces that leave have no place; item: old place.
struct LeavePlaces {
  const Index *face, *to;  // [old place]
  Index* place;            // [face]
  CDEM_HD void operator()(One x) const {
    if (to[x.i] < 0) place[face[x.i]] = -1;
  }
};
struct TakePlaces {
  const Index* face;  // [new place]
  Index* place;       // [face]
  CDEM_HD void operator()(One x) const { place[face[x.i]] = x.i; }
};

/// End the contacts of vertices with faces that leave; item: slot, at its old place.
struct DropTargetsThatLeave {
  const Index* to;
  Index *target, *target_before;
  Real *state, *reaction, *rolling;  // rows of 8; null: there are none
  CDEM_HD void operator()(One slot) const {
    const Index face = target[slot.i];
    if (face < 0 || to[face] >= 0) return;
    target[slot.i] = target_before[slot.i] = -1;
    for (Real* const rows : {state, reaction, rolling})
      for (std::size_t k = 0; rows && k < 8; ++k) rows[8 * std::size_t(slot.i) + k] = 0;
  }
};

/// Numbers of an exposed face come to its new place; those of a new one begin with a value.
template <class T>
struct GatherRows {
  const T* from;
  T* into;
  Index width;  // numbers of a face
  Index known;  // faces that had numbers
  T initial;
  const Index* before;  // [new place] old one, or -1
  const Index* to;      // where the numbers are places of exposed faces: their new ones; else null

  CDEM_HD void operator()(One x) const {
    const Index old = before[x.i];
    const bool has = old >= 0 && old < known;
    const T* const row = from + std::size_t(has ? old : 0) * width;
    T* const own = into + std::size_t(x.i) * width;
    for (Index k = 0; k < width; ++k) own[k] = has ? moved(row[k]) : initial;
  }

 private:
  CDEM_HD T moved(T number) const {
    if constexpr (std::is_same_v<T, Index>)
      if (to && number >= 0) return to[number];
    return number;
  }
};

}  // namespace cdem
