// separating_planes.hpp - two patches: how they may move, and which parts of either are in reach of
// the other.
#pragma once

#include <cstdint>

#include "core/bonds/bonded_view.hpp"
#include "core/contact/broad_phase/element_patch.hpp"
#include "core/contact/broad_phase/predicted_node.hpp"
#include "core/contact/geometry/face_geometry.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// Data for the search of pairs of patches.
struct PairContext {
  SearchRules rules;
  Real lookahead_time;  // [s]
  FaceColumns faces;
  PredictedNodes predicted;
  const Real* face_reach;      // [face]  [m]
  const ExposedFace* exposed;  // [exposed]
  const ExposedSide* sides;    // [exposed][4]
  const Patch* patches;
  BondedView bonded;
  const Index *target, *edge_first, *edge_contact;  // [slot], [exposed + 1], rows of EdgeContact
};

/// A pair of patches, and their parts, as bits.
struct PatchPair {
  Index one, other;
  std::uint16_t edge[2], vertex[2];  // of either, that a plane keeps out of reach of the other
  std::uint64_t meets;               // faces that may touch, see `bit`
  std::uint64_t listed[2];  // faces on the lists, see `bit`: with those of the first as mothers,
                            // and with those of the second

  /// Of face i of one patch and face j of the other.
  CDEM_HD static std::uint64_t bit(Index i, Index j) { return std::uint64_t(1) << (6 * i + j); }

  /// May face i of patch `of` and face j of the other touch?
  CDEM_HD bool may_meet(Index of, Index i, Index j) const {
    return (meets & (of == 0 ? bit(i, j) : bit(j, i))) != 0;
  }
  /// The faces of the second that may touch one at an edge of the first, and the faces at an edge.
  CDEM_HD Index across(const Patch::Edge& e) const {
    return Index((meets >> 6 * e.face[0] | meets >> 6 * e.face[e.faces - 1]) & 63);
  }
  bool operator==(const PatchPair&) const = default;
  CDEM_HD static Index at(const Patch::Edge& e) {
    return 1 << e.face[0] | 1 << e.face[e.faces - 1];
  }
};

inline constexpr Real last_step = 1.05;  // the last step counts 1.5 times, see SearchRules::entry

/// How far a vertex of one face may move as seen from the other  [m].
CDEM_HD inline Real motion_between(const ExposedFace& x, const ExposedFace& y) {
  return norm(x.displacement - y.displacement) + x.deviation + y.deviation;
}

/// How far two predicted nodes may move apart until the next rebuild  [m].
CDEM_HD inline Real may_part(const PairContext& f, Index a, Index b) {
  const PredictedNode x = f.predicted.at(a), y = f.predicted.at(b);
  return f.lookahead_time * norm(x.velocity - y.velocity) + x.skin + y.skin;
}

/// How far their predicted paths part while an inner list holds  [m].
CDEM_HD inline Real ways_part_soon(const PairContext& f, Index a, Index b) {
  return inner_horizon * f.lookahead_time *
         norm(f.predicted.at(a).velocity - f.predicted.at(b).velocity);
}

/// How much the gap between anything of x and of y along a normal of y (or of both) may change, at
/// least and at most  [m].
struct GapChange {
  Real least, most;
  CDEM_HD GapChange(const ExposedFace& x, const ExposedFace& y, const Vec3<Real>& n) {
    const Real approach = dot(n, x.displacement - y.displacement),
               deviation = x.deviation + y.deviation;
    least = min_of(approach, 0.0) - deviation;
    most = max_of(approach, 0.0) + deviation;
  }
};

/// Farthest that an edge of one patch may be from the other at a rebuild, if it may be in contact
/// before the next one  [m]; without the displacements, which have a direction. It holds for
/// vertices as well that are not inside a block.
CDEM_HD inline Real farthest_crossing(const SearchRules& rules, const Patch& a, const Patch& b) {
  return last_step * (a.deviation + b.deviation) + a.deepest + b.deepest + rules.lifted +
         (rules.entry + 2 * rules.tolerance) * min_of(a.length, b.length) +
         2 * rules.indentation * max_of(a.reach, b.reach);
}

/// The same for anything. A vertex that is inside a block may begin deeper, at the nearest face
/// (see ResolveTargets), and so be farther from the element behind it than an edge, unless that
/// element is the block.
CDEM_HD inline Real farthest_contact(const SearchRules& rules, const Patch& a, const Patch& b) {
  return farthest_crossing(rules, a, b) +
         (a.whole && b.whole ? 0.0 : rules.depth * min_of(a.length, b.length));
}

/// Heights of the vertices of a patch along a normal  [m].
struct Heights {
  Real at[8], least = 1e300, most = -1e300;
  CDEM_HD Heights(const PairContext& f, const Patch& p, const Vec3<Real>& n,
                  const Vec3<Real>& origin) {
    for (Index v = 0; v < p.vertex_count; ++v) {
      at[v] = dot(n, f.faces.nodes.position(p.vertex[v]) - origin);
      least = min_of(at[v], least);
      most = max_of(at[v], most);
    }
  }
};

/// Does no plane along a face of either patch hold the two of a pair apart until the next rebuild?
struct MayMeet {
  PairContext f;

  CDEM_HD bool operator()(const PatchPair& pair) const {
    const Patch &a = f.patches[pair.one], &b = f.patches[pair.other];
    const Real room = farthest_contact(f.rules, a, b);
    const Vec3<Real> closing = Real(last_step) * (b.displacement - a.displacement);
    return !hold_apart(a, a, b, closing, room) && !hold_apart(b, a, b, closing, room);
  }

 private:
  /// Does a plane along a face of one of them?
  CDEM_HD bool hold_apart(const Patch& of, const Patch& a, const Patch& b,
                          const Vec3<Real>& closing, Real room) const {
    for (Index i = 0; i < of.face_count; ++i) {
      const ExposedFace& face = f.exposed[of.face[i]];
      const Heights of_a(f, a, face.normal, face.center), of_b(f, b, face.normal, face.center);
      const Real closer = dot(face.normal, closing);
      if (of_b.least - of_a.most + min_of(closer, 0.0) > room ||
          of_a.least - of_b.most - max_of(closer, 0.0) > room)
        return true;
    }
    return false;
  }
};

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

  CDEM_HD SeparatedParts(const PairContext& f, const Patch& a, const Patch& b) {
    const Real room = farthest_crossing(f.rules, a, b);
    const Vec3<Real> closing = Real(last_step) * (b.displacement - a.displacement);
    unsigned bit = 1;
    for (Index k = 0; k < 2; ++k) {
      const Patch& of = k == 0 ? a : b;
      for (Index i = 0; i < of.face_count; ++i, bit <<= 2)
        separate(f, f.exposed[of.face[i]], a, b, closing, room, bit);
    }
    spread(a, 0, b.whole);
    spread(b, 1, a.whole);
  }
  /// Can nothing of two faces touch, of the first patch and of the second?
  CDEM_HD bool hold_apart(Index x, Index y) const {
    return (nothing_on[0][x] && no_vertex_on[1][y]) || (nothing_on[1][y] && no_vertex_on[0][x]);
  }

 private:
  /// By planes along a face.
  CDEM_HD void separate(const PairContext& f, const ExposedFace& face, const Patch& a,
                        const Patch& b, const Vec3<Real>& closing, Real room, unsigned bit) {
    const Vec3<Real>& n = face.normal;
    const Heights of_a(f, a, n, face.center), of_b(f, b, n, face.center);
    const Real closer = dot(n, closing);
    const Real up = room + max_of(closer, 0.0), down = room - min_of(closer, 0.0);
    for (Index v = 0; v < a.vertex_count; ++v)
      vertex[0][v] |=
          (of_a.at[v] - of_b.most > up ? bit : 0) | (of_b.least - of_a.at[v] > down ? bit << 1 : 0);
    for (Index v = 0; v < b.vertex_count; ++v)
      vertex[1][v] |=
          (of_b.at[v] - of_a.most > down ? bit : 0) | (of_a.least - of_b.at[v] > up ? bit << 1 : 0);
  }
  CDEM_HD void spread(const Patch& p, Index of, bool other_is_whole) {
    for (Index e = 0; e < p.edge_count; ++e)
      edge[of][e] = vertex[of][p.edge[e].vertex[0]] & vertex[of][p.edge[e].vertex[1]];
    for (Index v = 0; v < p.vertex_count && !other_is_whole; ++v) vertex[of][v] = 0;
    for (Index i = 0; i < p.face_count; ++i) {
      unsigned all = ~0u;
      no_vertex_on[of][i] = true;
      for (Index v = 0; v < p.vertex_count; ++v) {
        if (p.corner[v][i] < 0) continue;
        all &= vertex[of][v];
        no_vertex_on[of][i] = no_vertex_on[of][i] && vertex[of][v];
      }
      nothing_on[of][i] = all;
    }
  }
};

/// Find the parts of a pair of patches that may touch: are there any faces?
struct FindMeetingParts {
  PairContext f;
  bool list_all;  // pairs of faces: those without a vertex or an edge too

  CDEM_HD bool operator()(PatchPair& pair) const {
    const Patch &a = f.patches[pair.one], &b = f.patches[pair.other];
    const SeparatedParts separated(f, a, b);
    pair.meets = 0;
    for (Index i = 0; i < a.face_count; ++i)
      for (Index j = 0; j < b.face_count; ++j)
        if (!separated.hold_apart(i, j) && may_touch(a.face[i], b.face[j]))
          pair.meets |= PatchPair::bit(i, j);
    if (!pair.meets) return false;
    for (Index of = 0; of < 2; ++of) {
      pair.vertex[of] = 0, pair.edge[of] = 0;
      for (Index v = 0; v < 8; ++v) pair.vertex[of] |= (separated.vertex[of][v] != 0) << v;
      for (Index e = 0; e < 12; ++e) pair.edge[of] |= (separated.edge[of][e] != 0) << e;
      pair.listed[of] = 0;
    }
    if (list_all) list_faces(pair);
    return true;
  }

 private:
  /// May anything of the two faces touch before the next rebuild?
  CDEM_HD bool may_touch(Index place_x, Index place_y) const {
    const ExposedFace &x = f.exposed[place_x], &y = f.exposed[place_y];
    return x.block != y.block && (x.movable || y.movable) &&
           dot(x.normal, y.normal) < -f.rules.opposing + x.rotation + y.rotation && !apart(x, y) &&
           !apart(y, x) && !f.bonded.faces(place_x, place_y);
  }
  /// All vertices of x stay above the plane of y until the next rebuild: they cannot touch.
  CDEM_HD bool apart(const ExposedFace& x, const ExposedFace& y) const {
    Real lowest = 1e300, span2 = 0;
    for (Index k = 0; k < x.shape.count(); ++k) {
      const Vec3<Real> arm = x.shape.x[k] - y.center;
      lowest = min_of(dot(y.normal, arm), lowest);
      span2 = max_of(dot(arm, arm), span2);
    }
    if (lowest < 0) return false;
    const Real turned = y.rotation * (sqrt_of(span2) + motion_between(x, y));
    return lowest + GapChange(x, y, y.normal).least > turned + y.warpage + f.rules.lifted;
  }
  CDEM_HD static void list_faces(PatchPair& pair) {
    for (Index i = 0; i < 6; ++i)
      for (Index j = 0; j < 6; ++j) {
        if (!pair.may_meet(0, i, j)) continue;
        pair.listed[0] |= PatchPair::bit(i, j);
        pair.listed[1] |= PatchPair::bit(j, i);
      }
  }
};

}  // namespace cdem
