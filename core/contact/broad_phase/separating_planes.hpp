// separating_planes.hpp - two patches: how they may move, and which parts of either are in reach of
// the other.
#pragma once

#include <algorithm>

#include "core/bonds/bonded_overlaps.hpp"
#include "core/contact/broad_phase/element_patch.hpp"
#include "core/contact/broad_phase/pair_buffer.hpp"
#include "core/contact/broad_phase/predicted_motion.hpp"
#include "core/contact/geometry/views.hpp"

namespace cdem {

/// Data for the search of one pair of patches.
struct PairContext {
  const Model& m;
  const State& s;
  const Unset<ExposedFace>& exposed;
  const Unset<ExposedSide>& sides;
  const Bonded& bonded;
  const FaceColumns faces = on_host(face_columns(m, s));
  const PredictedNodes predicted{s};
  const OnHost<const Real> face_reach = on_host(m.face_reach);
  const OnHost<const Index> target = on_host(s.springs.target), edge_first = on_host(s.edges.first),
                            edge_contact = on_host(s.edges.contact);
};

inline constexpr Real last_step = 1.05;  // the last step counts 1.5 times, see SearchRules::entry

/// How far a vertex of one face may move as seen from the other  [m].
inline Real motion_between(const ExposedFace& x, const ExposedFace& y) {
  return norm(x.displacement - y.displacement) + x.deviation + y.deviation;
}

/// How far two predicted nodes may move apart until the next rebuild  [m].
inline Real may_part(const PairContext& f, Index a, Index b) {
  const PredictedNode x = f.predicted.at(a), y = f.predicted.at(b);
  return f.s.search.outer.lookahead_time * norm(x.velocity - y.velocity) + x.skin + y.skin;
}

/// How far their predicted paths part while an inner list holds  [m].
inline Real ways_part_soon(const PairContext& f, Index a, Index b) {
  return inner_horizon * f.s.search.outer.lookahead_time *
         norm(f.predicted.at(a).velocity - f.predicted.at(b).velocity);
}

/// How much the gap between anything of x and of y along a normal of y (or of both) may change, at
/// least and at most  [m].
struct GapChange {
  Real least, most;
  GapChange(const ExposedFace& x, const ExposedFace& y, const Vec3<Real>& n) {
    const Real approach = dot(n, x.displacement - y.displacement),
               deviation = x.deviation + y.deviation;
    least = std::min(approach, 0.0) - deviation;
    most = std::max(approach, 0.0) + deviation;
  }
};

/// Farthest that an edge of one patch may be from the other at a rebuild, if it may be in contact
/// before the next one  [m]; without the displacements, which have a direction. It holds for
/// vertices as well that are not inside a block.
inline Real farthest_crossing(const SearchRules& rules, const Patch& a, const Patch& b) {
  return last_step * (a.deviation + b.deviation) + a.deepest + b.deepest + rules.lifted +
         (rules.entry + 2 * rules.tolerance) * std::min(a.length, b.length) +
         2 * rules.indentation * std::max(a.reach, b.reach);
}

/// The same for anything. A vertex that is inside a block may begin deeper, at the nearest face
/// (see ResolveTargets), and so be farther from the element behind it than an edge, unless that
/// element is the block.
inline Real farthest_contact(const SearchRules& rules, const Patch& a, const Patch& b) {
  return farthest_crossing(rules, a, b) +
         (a.whole && b.whole ? 0.0 : rules.depth * std::min(a.length, b.length));
}

/// Vertices and edges of two patches that a plane along a face keeps out of the reach of the other
/// until the next rebuild: no such edge can touch, and no such vertex that is outside the block.
/// (Patches that a plane separates as a whole are no pair at all.)
///
/// A vertex that is inside a block may begin deeper than that, at the nearest face (see
/// ResolveTargets). It is in reach of a patch that is a block by itself. Beyond a patch whose block
/// goes on behind it, a vertex may be inside another element of that block.
struct SeparatedParts {
  // Which vertices lie on the far side of the other patch: two bits for each normal, one for either
  // end of it. A face or edge lies there as a whole if all its vertices lie on the same far side.
  unsigned vertex[2][8] = {}, edge[2][12] = {};
  bool nothing_on[2][6];  // face: none of its vertices, nor of its edges
  bool no_vertex_on[2][6];

  SeparatedParts(const PairContext& f, const Patch& a, const Patch& b);
  /// Can nothing of two faces touch, of the first patch and of the second?
  bool hold_apart(Index x, Index y) const {
    return (nothing_on[0][x] && no_vertex_on[1][y]) || (nothing_on[1][y] && no_vertex_on[0][x]);
  }

 private:
  void spread(const Patch& p, int of, bool other_is_whole);
};

/// Which faces of two patches may touch, bit by bit: row = face of the first.
struct FacePairMask {
  int row[6] = {};
  FacePairMask(const PairContext& f, const Patch& a, const Patch& b,
               const SeparatedParts& separated);
  bool any() const { return row[0] || row[1] || row[2] || row[3] || row[4] || row[5]; }
  /// The faces of the second that may touch one at an edge of the first, and the faces at an edge.
  int of(const Patch::Edge& e) const { return row[e.face[0]] | row[e.face[e.faces - 1]]; }
  static int at(const Patch::Edge& e) { return 1 << e.face[0] | 1 << e.face[e.faces - 1]; }
};

/// Faces of two patches that lists have for each other, bit by bit: `row[reverse]`, with those of
/// the first patch as mothers, and then with those of the second.
struct ListedFacePairs {
  int row[2][6] = {};

  void add(bool reverse, Index mother, Index face) { row[reverse][mother] |= 1 << face; }
  /// All that may touch, with or without a vertex or an edge.
  void add(const FacePairMask& pairs);
  void list(const Patch& a, const Patch& b, PairBuffer& found) const;
};

}  // namespace cdem
