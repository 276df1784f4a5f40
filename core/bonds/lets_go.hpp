// lets_go.hpp - which bonded pairs are to be released, and which have become hinges.
#pragma once

#include "core/interfaces/laws.hpp"
#include "core/records/pair_status.hpp"

namespace cdem {

/// Contacts have no cohesion: a pair whose broken bonds have some left is not released while it is
/// pressed, until it has slid by this part of its length.
inline constexpr Real slide_part = 0.3;

/// Has a broken pair moved by more than a part of its length, and does nothing keep it?
struct LetsGo {
  Real part;
  const Flag* status;
  const Real* jump;    // [pair] of what is broken  [m]
  const Real* stored;  // [pair]  [J]
  const Index* faces;  // [pair][2]
  const Index* interface;
  const Real* face_length;
  InterfaceTable interfaces;

  CDEM_HD bool operator()(One pair) const {
    const Real way = jump[pair.i];
    if (!is_live(PairStatus(status[pair.i])) || !(way > 0)) return false;
    const Real length = min_of(face_length[faces[2 * pair.i + 1]], face_length[faces[2 * pair.i]]);
    if (!(way > part * length)) return false;
    const bool pressed = stored[pair.i] > 0;
    return !pressed || !(residual_cohesion(interface[pair.i]) > 0) || way > slide_part * length;
  }

 private:
  /// Cohesion that broken bonds of an interface have left  [Pa].
  CDEM_HD Real residual_cohesion(Index of) const {
    Real left = 0;
    InterfaceLaws::for_each([&]<template <class> class Law, Index number>() {
      if constexpr (requires { &Law<Real>::broken_cohesion; })
        if (interfaces.interfaces[of].law == number)
          left =
              Law<Real>::broken_cohesion(interfaces.parameters + std::size_t(of) * parameter_row);
    });
    return left;
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
