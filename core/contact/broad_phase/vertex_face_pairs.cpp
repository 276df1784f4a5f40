// vertex_face_pairs.cpp - see vertex_face_pairs.hpp.
#include "core/contact/broad_phase/vertex_face_pairs.hpp"

#include <algorithm>

#include "core/contact/broad_phase/separating_planes.hpp"

namespace cdem {

namespace {

/// Gap that a vertex of exposed face x at `v` may have to exposed face y until the next rebuild.
struct GapRange {
  Real least, most;
  GapRange(const ExposedFace& x, const ExposedFace& y, const Vec3<Real>& v) {
    const Vec3<Real> arm = v - y.center;
    const GapChange change(x, y, y.normal);
    const Real gap = dot(y.normal, arm);
    const Real room = y.rotation * (norm(arm) + motion_between(x, y)) + y.warpage;
    least = gap + change.least - room;
    most = gap + change.most + room;
  }
};

/// May a contact with a face go on behind the corner at its side, where the surface rises (see
/// ResolveTargets::behind_corner)?
bool may_go_behind(const PairContext& f, const Vec3<Real>& v, const ExposedFace& x,
                   const ExposedSide& side) {
  return side.rises && GapRange(x, f.exposed[side.across], v).least <= 0;
}

/// May a vertex penetrate deeper than contacts with exposed face y begin, and be held there (see
/// ResolveTargets::encloses)? `entry` is that depth, `length` L.
bool may_penetrate(const PairContext& f, const Vec3<Real>& v, const ExposedFace& x,
                   const ExposedFace& y, Index place_y, Real entry, Real length) {
  const GapRange gap(x, y, v);
  const Real deepest = std::min(f.m.rules.depth * length, 0.5 * f.faces.face_height[y.face]);
  if (gap.least > -entry || gap.most < -deepest) return false;
  for (Index j = 0; j < y.shape.count(); ++j) {
    const ExposedSide& side = f.sides[4 * std::size_t(place_y) + j];
    if (side.across < 0) continue;
    const ExposedFace& u = f.exposed[side.across];
    const Vec3<Real> arm = u.center - y.center;
    const bool falls = dot(y.normal, arm) < -(y.rotation + u.rotation) * norm(arm);
    if (falls && GapRange(x, u, v).least > gap.most) return false;
  }
  return true;
}

/// Does a point that moves as exposed face x does stay beside exposed face y until the next
/// rebuild, farther than `room` [m]? `v` is the vertex that it belongs to.
bool stays_beside(const PairContext& f, const Vec3<Real>& v, const Vec3<Real>& point,
                  const ExposedFace& x, Index place_y, Real room) {
  const ExposedFace& y = f.exposed[place_y];
  for (Index j = 0; j < y.shape.count(); ++j) {
    const ExposedSide& side = f.sides[4 * std::size_t(place_y) + j];
    const Vec3<Real> from = point - side.start;
    if (dot(cross(y.normal, side.along), from) <
            -(room + 2 * y.rotation * (norm(from) + room)) * side.length &&
        !may_go_behind(f, v, x, side))
      return true;
  }
  return false;
}

/// May a vertex of exposed face x come into contact with exposed face y before the next rebuild?
/// The tests of ResolveTargets::qualify with room for the motion; `reach` is that of the largest
/// of the faces at the vertex, `least` the L of the smallest. A vertex that a bond holds to y has
/// no contact there through its other faces too.
bool may_touch(const PairContext& f, Index node, const ExposedFace& x, Real length, Real reach,
               Real least, Index place_y) {
  const ExposedFace& y = f.exposed[place_y];
  const SearchRules& rules = f.m.rules;
  const Real motion = motion_between(x, y);
  const GapChange change(x, y, y.normal);
  const Vec3<Real> v = f.faces.nodes.position(node), arm = v - y.center;
  const Real gap_room = y.rotation * (norm(arm) + motion) + y.warpage, gap = dot(y.normal, arm);
  if (gap + change.least > gap_room + rules.lifted ||
      gap + change.most < -rules.depth * length - gap_room)
    return false;
  if (stays_beside(f, v, v, x, place_y,
                   rules.tolerance * length + rules.indentation * reach + motion))
    return false;
  for (Index j = 0; j < y.shape.count(); ++j)
    if (f.faces.bonded_node[f.faces.vertex(y.face, j)] == f.faces.bonded_node[node]) return false;
  if (Bonded::among(f.bonded.vertices, node, place_y)) return false;
  if (may_penetrate(f, v, x, y, place_y, rules.entry * std::min(least, y.length), length))
    return true;
  const Index point = f.faces.bonded_node[node];  // never the deepest vertex?
  for (Index r = f.faces.edge_star_first[point]; r < f.faces.edge_star_first[point + 1]; ++r) {
    const Index other = f.faces.edge_star[r];
    if (!f.predicted.has(other)) continue;
    const Vec3<Real> d = f.faces.nodes.position(other) - v;
    const Real moved = may_part(f, other, node);
    const Real long_d = norm(d), rotation = 2 * moved / long_d + y.rotation;
    if (dot(d, y.normal) < -(rules.cone + rotation) * long_d) return false;
  }
  return true;
}

/// Room of a vertex and a face that may touch; `length` as above, `indented` is how far
/// its indented points are from the vertex, at most, and `deviation` how far its faces are strained
/// and rotated while an inner list holds.
///
/// In contact the vertex is at a point of the face but for the depth and for `off` beside it, more
/// behind a corner (or from the centre of a warped face), of which the rotation of the face changes
/// the view along its sides, or its normal.
PairBuffer::VertexFacePair vertex_face(const PairContext& f, Index node, Index place_y, Real length,
                                       Real indented, Real deviation) {
  const SearchRules& rules = f.m.rules;
  const ExposedFace& y = f.exposed[place_y];
  const Real slack = 1e-6 * y.length;  // for round-off
  const Real above = (y.shape.count() == 3 ? 0 : 0.5 * y.length) + y.warpage + slack;
  const Real aside = rules.tolerance * length + indented + slack;
  const Index last = y.shape.count() == 3 ? 2 : 3;
  const ExposedSide* sides = f.sides.data() + 4 * std::size_t(place_y);
  Index behind = 0;  // sides, as bits
  for (Index k = 0; k <= 3; ++k) behind |= Index(sides[std::min(k, last)].rises) << k;
  const Real reach = 1.34 * f.face_reach[y.face] + aside;
  const Real off =
      behind ? 2 * reach : std::max(2 * aside * y.slender, last == 3 ? 0.5 * reach : 0.0);
  Real parted = 0;
  for (Index k = 0; k <= last; ++k)
    parted = std::max(parted, ways_part_soon(f, node, f.faces.vertex(y.face, k)));
  const Real motion =
      parted + rules.indentation * 2 * deviation + 2 * y.rotation_soon * off + slack;
  return {{node, place_y},
          {float(above + rules.lifted + motion), float(above + rules.depth * length + motion),
           float(aside + motion), float(behind), float(reach + motion), float(motion)}};
}

/// The faces of a patch that meet at one of its vertices and may touch a face of another patch.
struct FacesAtVertex {
  Index first = -1;      // of the patch; -1: there is none
  Real least = 1e300;    // L of the smallest  [m]
  bool touches = false;  // does the vertex have a contact there through one of them?
};

/// How far the indented points of a vertex are from it and may deviate, at most  [m].
struct IndentedPoints {
  Real shift = 0, deviation = 0;
};

/// Vertices of patch a on faces of patch b; `reverse` where a is the second one of `pairs`.
struct VertexFaceSearch {
  const PairContext& f;
  const Patch &a, &b;
  const FacePairMask& pairs;
  bool reverse;

  bool may_meet(Index i, Index j) const {
    return (reverse ? pairs.row[j] >> i : pairs.row[i] >> j) & 1;
  }
  FacesAtVertex faces_at(Index v, Index j) const {
    FacesAtVertex at;
    for (Index i = a.face_count - 1; i >= 0; --i) {
      if (a.corner[v][i] < 0 || !may_meet(i, j)) continue;
      at.first = i;
      at.least = std::min(at.least, f.exposed[a.face[i]].length);
      const std::size_t slot = 4 * std::size_t(a.face[i]) + a.corner[v][i];
      at.touches = at.touches || f.target[slot] == b.face[j];
    }
    return at;
  }
  /// List the semi-springs of a vertex that may touch face j, as candidates of the next pair.
  IndentedPoints list_semi_springs(Index v, Index j, bool touches, Real length,
                                   ListedFacePairs& listed, PairBuffer& found) const {
    const Vec3<Real> at = f.faces.nodes.position(a.vertex[v]);
    IndentedPoints points;
    for (Index i = 0; i < a.face_count; ++i) {
      if (a.corner[v][i] < 0 || !may_meet(i, j)) continue;
      const ExposedFace &x = f.exposed[a.face[i]], &y = f.exposed[b.face[j]];
      const Vec3<Real> arm = x.center - at, indented = at + f.m.rules.indentation * arm;
      if (!touches && stays_beside(f, at, indented, x, b.face[j],
                                   f.m.rules.tolerance * length + motion_between(x, y)))
        continue;
      points.shift = std::max(points.shift, f.m.rules.indentation * (norm(arm) + 2 * x.deviation));
      points.deviation = std::max(points.deviation, x.deviation_soon);
      listed.add(reverse, i, j);
      found.candidates.push_back({.slot = 4 * a.face[i] + a.corner[v][i],
                                  .face = b.face[j],
                                  .pair = Index(found.vertex_faces.size())});
    }
    return points;
  }
  void list(Index v, Index j, ListedFacePairs& listed, PairBuffer& found) const {
    const FacesAtVertex at = faces_at(v, j);
    if (at.first < 0) return;
    const Real length = std::min(a.length, f.exposed[b.face[j]].length);
    if (!at.touches && !may_touch(f, a.vertex[v], f.exposed[a.face[at.first]], length, a.reach,
                                  at.least, b.face[j]))
      return;
    const IndentedPoints points = list_semi_springs(v, j, at.touches, length, listed, found);
    if (points.shift == 0) return;  // nothing is listed
    found.vertex_faces.push_back(
        vertex_face(f, a.vertex[v], b.face[j], length, points.shift, points.deviation));
  }
};

}  // namespace

void list_vertex_face_pairs(const PairContext& f, const Patch& a, const Patch& b,
                            const FacePairMask& pairs, const SeparatedParts& separated,
                            bool reverse, ListedFacePairs& listed, PairBuffer& found) {
  const VertexFaceSearch search{.f = f, .a = a, .b = b, .pairs = pairs, .reverse = reverse};
  for (Index j = 0; j < b.face_count; ++j)
    for (Index v = 0; v < a.vertex_count; ++v)
      if (!separated.vertex[reverse][v]) search.list(v, j, listed, found);
}

}  // namespace cdem
