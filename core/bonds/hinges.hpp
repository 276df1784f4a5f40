// hinges.hpp - kernels that open the pairs that hold by some of their points alone.
#pragma once

#include "core/bonds/bonded_pairs.hpp"
#include "core/bonds/broken_pairs.hpp"

namespace cdem {

/// A broken point of a pair.
struct BrokenPoint {
  Vec3<Real> jump;  // that strains its spring  [m]
  Real area;        // [m2]
  JointInput<Real> in;
  Real history[InterfaceLaws::most_state + 1];

  /// Point k of `points` of an item of the point tables.
  CDEM_HD static BrokenPoint of(const PairColumns& pairs, One item, Index k, Index points,
                                const Frame<Real>& frame, const Vec3<Real>& jump,
                                const BondSpring<Real>& spring) {
    const BondHistory<Real> slipped{
        .bond = 0, .slip1 = pairs.slip1.at(k, item), .slip2 = pairs.slip2.at(k, item)};
    BrokenPoint point{
        .jump = jump, .area = spring.area, .in = spring.input(frame, jump, slipped), .history = {}};
    pairs.load_history<InterfaceLaws>(item, k, points, point.history);
    return point;
  }
};

/// The broken points of conforming pairs.
template <Index count>
struct BrokenOfConforming {
  ConformingBonds<count> bonds;

  CDEM_HD const PairColumns& pairs() const { return bonds.pairs; }
  /// Call act(point) for each of a pair.
  template <class Act>
  CDEM_HD void each(One pair, const Act& act) const {
    Vec3<Real> jump[count];
    const Frame<Real> frame = bonds.gather_jumps(pair, jump);
    for (Index k = 0; k < count; ++k) {
      if (pairs().bond.at(k, pair) > 0) continue;
      BrokenPoint point =
          BrokenPoint::of(pairs(), pair, k, count, frame, jump[k], bonds.spring(pair));
      act(point);
    }
  }
};

/// The same of faces that overlap.
struct BrokenOfOverlaps {
  OverlapBonds bonds;

  CDEM_HD const PairColumns& pairs() const { return bonds.pairs; }
  template <class Act>
  CDEM_HD void each(One pair, const Act& act) const {
    const Index a = bonds.pair_faces[2 * pair.i], b = bonds.pair_faces[2 * pair.i + 1];
    const Frame<Real> frame = bonds.frame_of(a, b);
    for (Index c = bonds.point_first[pair.i]; c < bonds.point_first[pair.i + 1]; ++c) {
      if (pairs().bond.at(0, One{c}) > 0) continue;
      BrokenPoint point =
          BrokenPoint::of(pairs(), One{c}, 0, 1, frame, bonds.jump_at(a, b, frame, c),
                          pairs().spring(pair, bonds.point_area[c]));
      act(point);
    }
  }
};

/// Has a pair that holds by some of its points opened as a hinge? See select_items.
template <class Points>
struct OpensAsHinge {
  HoldsInPart holds_in_part;
  Points points;
  PairLengths lengths;

  /// A pair that is this part of its length apart at a broken point is a hinge: bodies between its
  /// faces touch them.
  static constexpr Real part = 0.05;

  CDEM_HD bool operator()(One pair) const {
    if (!holds_in_part(pair)) return false;
    Real widest = 0;
    points.each(pair, [&](const BrokenPoint& point) { widest = max_of(widest, norm(point.jump)); });
    return widest > part * lengths.at(pair.i);
  }
};

/// Open it. Its broken points carry nothing any more; their small energy is lost to friction.
template <class Points>
struct OpenHinge {
  const Index* hinges;
  Points points;
  Flag* status;

  CDEM_HD void operator()(One item) const {
    const One pair{hinges[item.i]};
    const PairColumns& pairs = points.pairs();
    const auto laws = pairs.laws<InterfaceLaws>(pair);
    Real friction = pairs.friction.at(0, pair), stored = pairs.stored.at(0, pair);
    points.each(pair, [&](BrokenPoint& point) {
      const JointAnswer<Real> joint = laws.respond(point.in, point.history);
      const Real held = point.area * (joint.stored_n + joint.stored_s);
      friction += held;
      stored -= held;
    });
    pairs.friction.set(0, pair, friction);
    pairs.stored.set(0, pair, stored);
    status[pair.i] = Flag(PairStatus::hinge);
  }
};

}  // namespace cdem
