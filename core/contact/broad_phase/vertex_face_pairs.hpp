// vertex_face_pairs.hpp - which vertices of one patch may touch faces of another.
#pragma once

#include "core/base/parallel.hpp"
#include "core/base/short_numbers.hpp"
#include "core/contact/broad_phase/pair_items.hpp"
#include "core/contact/broad_phase/separating_planes.hpp"

namespace cdem {

/// The two patches of an item.
struct VertexAndFace {
  const PairContext& f;
  const PatchPair& pair;
  VertexFaceItem item;
  const Patch &a, &b;  // of the vertex, of the face

  CDEM_HD VertexAndFace(const PairContext& context, const PatchPair* pairs,
                        const VertexFaceItem& of)
      : f(context),
        pair(pairs[of.pair]),
        item(of),
        a(f.patches[of.of == 0 ? pair.one : pair.other]),
        b(f.patches[of.of == 0 ? pair.other : pair.one]) {}
  CDEM_HD Index node() const { return a.vertex[item.vertex]; }
  CDEM_HD Vec3<Real> position() const { return f.faces.nodes.position(node()); }
  CDEM_HD Index place_y() const { return b.face[item.face]; }
  CDEM_HD const ExposedFace& y() const { return f.exposed[place_y()]; }
  CDEM_HD const ExposedFace& x(Index i) const { return f.exposed[a.face[i]]; }
  CDEM_HD Real length() const { return min_of(a.length, y().length); }
  /// Is a face of the patch at the vertex, and may it meet the other one?
  CDEM_HD bool has_mother(Index i) const {
    return a.corner[item.vertex][i] >= 0 && pair.may_meet(item.of, i, item.face);
  }
  CDEM_HD Index slot(Index i) const { return 4 * a.face[i] + a.corner[item.vertex][i]; }
};

/// Call act(item) for all vertices and faces of a pair of patches that no plane holds apart.
struct ListVertexFaces {
  PairContext f;
  const PatchPair* pairs;
  Index first = 0;  // pair of row 0

  template <class Act>
  CDEM_HD void visit(One row, const Act& act) const {
    const Index place = first + row.i;
    const PatchPair& pair = pairs[place];
    for (Index of = 0; of < 2; ++of) {
      const Patch &a = f.patches[of == 0 ? pair.one : pair.other],
                  &b = f.patches[of == 0 ? pair.other : pair.one];
      for (Index j = 0; j < b.face_count; ++j) {
        Index meets = 0;
        for (Index i = 0; i < a.face_count; ++i) meets |= Index(pair.may_meet(of, i, j)) << i;
        for (Index v = 0; meets && v < a.vertex_count; ++v) {
          if (pair.vertex[of] >> v & 1) continue;
          Index mothers = 0;
          for (Index i = 0; i < a.face_count; ++i)
            mothers |= (meets >> i & 1 && a.corner[v][i] >= 0) << i;
          if (mothers)
            act(VertexFaceItem{.pair = place,
                               .mothers = unsigned(mothers),
                               .of = unsigned(of),
                               .face = unsigned(j),
                               .vertex = unsigned(v)});
        }
      }
    }
  }
};

/// Gap that a vertex of exposed face x at `v` may have to exposed face y until the next rebuild.
struct GapRange {
  Real least, most;
  CDEM_HD GapRange(const ExposedFace& x, const ExposedFace& y, const Vec3<Real>& v) {
    const Vec3<Real> arm = v - y.center;
    const GapChange change(x, y, y.normal);
    const Real gap = dot(y.normal, arm);
    const Real room = y.rotation * (norm(arm) + motion_between(x, y)) + y.warpage;
    least = gap + change.least - room;
    most = gap + change.most + room;
  }
};

/// May a vertex of one patch come into contact with a face of the other before the next rebuild?
/// The tests of ResolveTargets::qualify with room for the motion. A vertex that a bond holds to the
/// face has no contact there through its other faces too. Keeps the faces at the vertex whose
/// semi-springs may.
struct VertexMayTouch {
  PairContext f;
  const PatchPair* pairs;

  CDEM_HD bool operator()(VertexFaceItem& item) const {
    const VertexAndFace at(f, pairs, item);
    bool touches = false;  // does the vertex have a contact there already?
    Real least = 1e300;    // L of the smallest face at it  [m]
    Index first = -1;
    for (Index i = at.a.face_count - 1; i >= 0; --i) {
      if (!(item.mothers >> i & 1)) continue;
      first = i;
      least = min_of(at.x(i).length, least);
      touches = touches || f.target[at.slot(i)] == at.place_y();
    }
    if (!touches && !may_touch(at, at.x(first), least)) return false;
    const Vec3<Real> v = at.position();
    for (Index i = 0; i < at.a.face_count; ++i) {
      if (touches || !(item.mothers >> i & 1)) continue;
      const Vec3<Real> indented = v + f.rules.indentation * (at.x(i).center - v);
      if (stays_beside(v, indented, at.x(i), at.place_y(),
                       f.rules.tolerance * at.length() + motion_between(at.x(i), at.y())))
        item.mothers &= ~(1u << i);
    }
    return item.mothers != 0;
  }

 private:
  CDEM_HD bool may_touch(const VertexAndFace& at, const ExposedFace& x, Real least) const {
    const ExposedFace& y = at.y();
    const SearchRules& rules = f.rules;
    const Real motion = motion_between(x, y), length = at.length();
    const GapChange change(x, y, y.normal);
    const Vec3<Real> v = at.position(), arm = v - y.center;
    const Real gap_room = y.rotation * (norm(arm) + motion) + y.warpage, gap = dot(y.normal, arm);
    if (gap + change.least > gap_room + rules.lifted ||
        gap + change.most < -rules.depth * length - gap_room)
      return false;
    if (stays_beside(v, v, x, at.place_y(),
                     rules.tolerance * length + rules.indentation * at.a.reach + motion))
      return false;
    if (is_bonded(at.node(), y, at.place_y())) return false;
    return may_penetrate(v, x, at.place_y(), rules.entry * min_of(y.length, least), length) ||
           may_be_deepest(at.node(), v, y);
  }
  /// Does a bond hold a vertex to exposed face y?
  CDEM_HD bool is_bonded(Index node, const ExposedFace& y, Index place_y) const {
    for (Index j = 0; j < y.shape.count(); ++j)
      if (f.faces.bonded_node[f.faces.vertex(y.face, j)] == f.faces.bonded_node[node]) return true;
    return f.bonded.vertices(node, place_y);
  }
  /// May no neighbour of a vertex be deeper all the time?
  CDEM_HD bool may_be_deepest(Index node, const Vec3<Real>& v, const ExposedFace& y) const {
    const Index point = f.faces.bonded_node[node];
    for (Index r = f.faces.edge_star_first[point]; r < f.faces.edge_star_first[point + 1]; ++r) {
      const Index other = f.faces.edge_star[r];
      if (!f.predicted.has(other)) continue;
      const Vec3<Real> d = f.faces.nodes.position(other) - v;
      const Real moved = may_part(f, other, node);
      const Real long_d = norm(d), rotation = 2 * moved / long_d + y.rotation;
      if (dot(d, y.normal) < -(f.rules.cone + rotation) * long_d) return false;
    }
    return true;
  }
  /// May a vertex penetrate deeper than contacts with exposed face y begin, and be held there (see
  /// ResolveTargets::encloses)? `entry` is that depth, `length` L.
  CDEM_HD bool may_penetrate(const Vec3<Real>& v, const ExposedFace& x, Index place_y, Real entry,
                             Real length) const {
    const ExposedFace& y = f.exposed[place_y];
    const GapRange gap(x, y, v);
    const Real deepest = min_of(f.rules.depth * length, 0.5 * f.faces.face_height[y.face]);
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
  CDEM_HD bool stays_beside(const Vec3<Real>& v, const Vec3<Real>& point, const ExposedFace& x,
                            Index place_y, Real room) const {
    const ExposedFace& y = f.exposed[place_y];
    for (Index j = 0; j < y.shape.count(); ++j) {
      const ExposedSide& side = f.sides[4 * std::size_t(place_y) + j];
      const Vec3<Real> from = point - side.start;
      if (dot(cross(y.normal, side.along), from) <
              -(room + 2 * y.rotation * (norm(from) + room)) * side.length &&
          !may_go_behind(v, x, side))
        return true;
    }
    return false;
  }
  /// May a contact with a face go on behind the corner at its side, where the surface rises (see
  /// ResolveTargets::behind_corner)?
  CDEM_HD bool may_go_behind(const Vec3<Real>& v, const ExposedFace& x,
                             const ExposedSide& side) const {
    return side.rises && GapRange(x, f.exposed[side.across], v).least <= 0;
  }
};

/// Write the pairs of vertex and face, see MarkNearFaces. Lists the faces that they are of.
///
/// In contact the vertex is at a point of the face but for the depth and for `off` beside it, more
/// behind a corner (or from the centre of a warped face), of which the rotation of the face changes
/// the view along its sides, or its normal.
struct WriteVertexFaces {
  PairContext f;
  PatchPair* pairs;
  const VertexFaceItem* items;
  Index stride;
  Index* of;    // [2][pair]: node, exposed face
  Short* room;  // [6][pair]
  bool alone;   // see raise

  CDEM_HD void operator()(One place) const {
    const VertexAndFace at(f, pairs, items[place.i]);
    const Vec3<Real> v = at.position();
    Real indented = 0, deviation = 0;  // of the points from the vertex, and of its faces, at most
    std::uint64_t listed = 0;
    for (Index i = 0; i < at.a.face_count; ++i) {
      if (!(at.item.mothers >> i & 1)) continue;
      const ExposedFace& x = at.x(i);
      const Real part = f.rules.indentation;
      indented = max_of(part * (norm(x.center - v) + 2 * x.deviation), indented);
      deviation = max_of(x.deviation_soon, deviation);
      listed |= PatchPair::bit(i, at.item.face);
    }
    raise_bits(pairs[at.item.pair].listed[at.item.of], listed, alone);
    of[place.i] = at.node();
    of[std::size_t(stride) + place.i] = at.place_y();
    write_room(at, indented, deviation, room + place.i);
  }

 private:
  CDEM_HD void write_room(const VertexAndFace& at, Real indented, Real deviation,
                          Short* rooms) const {
    const SearchRules& rules = f.rules;
    const ExposedFace& y = at.y();
    const Real length = at.length(), slack = 1e-6 * y.length;  // for round-off
    const Real above = (y.shape.count() == 3 ? 0 : 0.5 * y.length) + y.warpage + slack;
    const Real aside = rules.tolerance * length + indented + slack;
    const Index last = y.shape.count() == 3 ? 2 : 3;
    const ExposedSide* sides = f.sides + 4 * std::size_t(at.place_y());
    Index behind = 0;  // sides, as bits
    for (Index k = 0; k <= 3; ++k) behind |= Index(sides[k < last ? k : last].rises) << k;
    const Real reach = 1.34 * f.face_reach[y.face] + aside;
    const Real off =
        behind ? 2 * reach : max_of(2 * aside * y.slender, last == 3 ? 0.5 * reach : 0.0);
    Real parted = 0;
    for (Index k = 0; k <= last; ++k)
      parted = max_of(ways_part_soon(f, at.node(), f.faces.vertex(y.face, k)), parted);
    const Real motion =
        parted + rules.indentation * 2 * deviation + 2 * y.rotation_soon * off + slack;
    const Real all[] = {above + rules.lifted + motion,
                        above + rules.depth * length + motion,
                        aside + motion,
                        Real(behind),
                        reach + motion,
                        motion};
    for (Index k = 0; k < 6; ++k) store(rooms + std::size_t(k) * stride, One{0}, round_up(all[k]));
  }
};

/// Call act(candidate) for the semi-springs of a vertex that may touch a face.
struct ListSemiSprings {
  PairContext f;
  const PatchPair* pairs;
  const VertexFaceItem* items;

  template <class Act>
  CDEM_HD void visit(One place, const Act& act) const {
    const VertexAndFace at(f, pairs, items[place.i]);
    for (Index i = 0; i < at.a.face_count; ++i)
      if (at.item.mothers >> i & 1) act(Candidate{at.slot(i), at.place_y(), place.i});
  }
};

}  // namespace cdem
