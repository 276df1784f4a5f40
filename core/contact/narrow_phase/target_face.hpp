// target_face.hpp - which face a semi-spring touches. Feng et al. (2014), Eq. 6-9.
#pragma once

#include "core/contact/narrow_phase/contact_columns.hpp"
#include "core/contact/narrow_phase/flush_faces.hpp"
#include "core/contact/narrow_phase/vertex_face.hpp"

namespace cdem {

/// Data for the search of target faces.
struct FaceSearch {
  FaceColumns faces;
  FaceGeometry geometry;
  const Index* exposed_face;
  Candidates candidates;
  SearchRules rules;
  SpringColumns springs;
  FlushFaces flush;

  /// How deep a vertex may have come to a face within the steps that rules.approach_steps says.
  template <class T, class Ids>
  CDEM_HD T approach(const Vec3<T>& normal, const Ids& node,
                     const FaceVertices<Ids>& corners) const {
    const auto velocity = [&](Index k) { return faces.nodes.velocity(corners.node[k]); };
    const Vec3<T> sum = velocity(0) + velocity(1) + velocity(2);
    const Vec3<T> mean =
        select(corners.quad(), T(1.0 / 4.0) * (sum + velocity(3)), T(1.0 / 3.0) * sum);
    return T(rules.approach_steps * faces.dt) *
           abs_of(dot(normal, faces.nodes.velocity(node) - mean));
  }

  CDEM_HD bool opposes(Index m, Index t) const {
    return dot(geometry.normal(m), geometry.normal(t)) < -rules.opposing;
  }
  CDEM_HD Real smaller_length(Index m, Index t) const {
    return min_of(geometry.length(m), geometry.length(t));
  }
  CDEM_HD Real plane_gap(const Vec3<Real>& v, Index t) const {
    return dot(geometry.normal(t), v - geometry.center(t));
  }
  /// A warped face may reach above its mean plane; a plane one does not.
  CDEM_HD Real above(Index t) const {
    return geometry.is_triangle(t) ? 0.0 : 0.5 * geometry.length(t);
  }
  /// Cheap part of the inside test: P lies within reach of the face's centre.
  CDEM_HD bool beside(const Vec3<Real>& p, Index t, Real tolerance) const {
    const Vec3<Real> n = geometry.normal(t), arm = p - geometry.center(t);
    const Real up = dot(n, arm), reach = geometry.table[t].reach + tolerance;
    return dot(arm, arm) - up * up < reach * reach;
  }
  /// No edge that leaves v, or a bonded node there, goes below the plane through v.
  CDEM_HD bool deepest(Index node, const Vec3<Real>& v, const Vec3<Real>& n) const {
    const Index point = faces.bonded_node[node];
    for (Index r = faces.edge_star_first[point]; r < faces.edge_star_first[point + 1]; ++r) {
      const Vec3<Real> d = faces.nodes.position(faces.edge_star[r]) - v;
      const Real down = -dot(d, n);
      if (down > 0 && down * down > rules.cone * rules.cone * dot(d, d)) return false;
    }
    return true;
  }
};

/// Begin the search of a step: the target becomes the old target.
struct BeginTargets {
  SpringColumns springs;

  CDEM_HD void operator()(One m) const {
    Index target[4];
    for (Index k = 0; k < 4; ++k) target[k] = springs.target[4 * m.i + k];
    for (Index k = 0; k < 4; ++k) springs.target_before[4 * m.i + k] = target[k];
    for (Index k = 0; k < 4; ++k) springs.unresolved[4 * m.i + k] = 0;
    for (Index k = 0; k < 4; ++k) springs.rim_action[4 * m.i + k] = 0;
  }
};

/// Keep the target of a semi-spring in contact where its tests hold, as most do: see
/// ResolveTargets, which decides the others.
struct UpdateHeldTargets : FaceSearch {
  CDEM_HD Range items(Index m) const { return {4 * m, 4 * m + 4}; }
  CDEM_HD bool selects(Index, Index slot) const { return springs.target_before[slot] >= 0; }

  template <class I>
  CDEM_HD void operator()(const I& item) const {
    using T = Number<I>;
    const auto& slot = item.id;
    const auto t = look_up(springs.target_before, slot);
    const auto node = indices_of([&](Index m, Index s) { return geometry.table[m].corner[s % 4]; },
                                 item.row, slot);
    const auto c = VertexFace<T>::at(faces, geometry, rules, item.row, node, t);
    const auto corners = geometry.vertices(t);
    const FaceShape<T> shape = faces.shape(corners);
    const T gap = project(shape, c.v, c.normal).gap;
    const T stress_free_gap = InRows{springs.state}.at(slot, 4).x, zero(0.0);
    const T lifted = T(2.0) * max_of(stress_free_gap, zero);
    const T depth = T(rules.depth) * c.length - min_of(stress_free_gap, zero);
    const auto other_node = [&](Index j) {
      return differ(look_up(faces.bonded_node, corners.node[j]), look_up(faces.bonded_node, node));
    };
    const auto kept = c.opposes & shape.inside(c.p, c.normal, T(rules.tolerance) * c.length) &
                      !((gap > lifted) | (gap < -depth)) & other_node(0) & other_node(1) &
                      other_node(2) & other_node(3);
    for_lanes(item, [&](Index lane, Index, Index id) {
      if (!holds(kept, lane)) springs.unresolved[id] = 1;
    });
  }
};

/// Filter, in SIMD lanes, the faces that semi-springs without contact may touch: most cannot. The
/// others are left to ResolveTargets. Its tests are the same without the room in the depth that
/// these have, so no contact depends on the filter.
struct FilterNewTargets : FaceSearch {
  /// Nothing where all vertices are in contact, as at rest.
  CDEM_HD Range items(Index m) const {
    const Index first = candidates.first[4 * m], *before = springs.target_before + 4 * m;
    const bool held = before[0] >= 0 && before[1] >= 0 && before[2] >= 0 &&
                      (before[3] >= 0 || geometry.table[m].count() == 3);
    return {first, held ? first : candidates.first[4 * m + 4]};
  }
  CDEM_HD bool selects(Index m, Index c) const {
    return springs.target_before[4 * m + vertex_of(candidates.first, m, c)] < 0;
  }

  template <class I>
  CDEM_HD void operator()(const I& item) const {
    using T = Number<I>;
    const auto t = look_up(candidates.other, item.id);
    const auto node = indices_of(
        [&](Index m, Index c) {
          return geometry.table[m].corner[vertex_of(candidates.first, m, c)];
        },
        item.row, item.id);
    const auto c = VertexFace<T>::at(faces, geometry, rules, item.row, node, t);
    const T zero(0.0), plane = dot(c.normal, c.v - c.center);
    const T above = select(c.target_length > zero, zero, T(-0.5) * c.target_length);
    const T room = T(rules.tolerance) * c.length;
    const Vec3<T> arm = c.p - c.center;
    const T up = dot(c.normal, arm),
            reach = numbers_of([&](Index x) { return geometry.table[x].reach; }, t) + room;
    const auto may = c.opposes & !(plane > above) & !(plane < T(-rules.depth) * c.length - above) &
                     (dot(arm, arm) - up * up < reach * reach);
    if (!any_of(may)) return mark(item, may);
    const auto corners = geometry.vertices(t);
    const FaceShape<T> shape = faces.shape(corners);
    auto inside = may & shape.inside(c.p, c.normal, room);
    const auto aside = may & !inside;
    if (any_of(aside) && any_of(aside & rises(item.id)))
      inside = inside | (aside & rises(item.id) & behind_corner(c, item.row, t, shape, room));
    const auto deep = may & (plane < T(-rules.entry) * c.length);
    auto begins = inside;
    if (any_of(inside)) {
      const T gap = project(shape, c.v, c.normal).gap;
      const T entry = T(rules.filter_room * rules.entry) * c.length;
      begins = begins & !(gap > zero);
      if (any_of(begins & (gap < -entry)))
        begins =
            begins & !(gap < -entry - T(rules.filter_room) * approach(c.normal, node, corners));
    }
    if (!any_of(deep)) return mark(item, begins);
    // a vertex deeper than a contact may begin must be inside the block
    mark(item, begins | (deep & !escapes(c, t, plane)));
  }

 private:
  static constexpr Real for_round_off = 1e-6;  // of a length, and of a sine

  template <class I, class M>
  CDEM_HD void mark(const I& item, const M& may) const {
    for_lanes(item, [&](Index lane, Index m, Index c) {
      candidates.may_begin[c] = holds(may, lane);
      if (holds(may, lane)) springs.unresolved[4 * m + vertex_of(candidates.first, m, c)] = 1;
    });
  }
  template <class Ids>
  CDEM_HD auto rises(const Ids& candidate) const {
    return numbers_of([&](Index c) { return candidates.rises[c]; }, candidate) > Number<Ids>(0.0);
  }
  /// May the vertex be behind a corner of the surface at every side of t that the indented point
  /// is outside of? See ResolveTargets::behind_corner.
  template <class T, class Ids>
  CDEM_HD Truth<T> behind_corner(const VertexFace<T>& c, const Ids& m, const Ids& t,
                                 const FaceShape<T>& shape, const T& room) const {
    const T slack = T(for_round_off) * c.length, sine(for_round_off);
    Truth<T> found = c.opposes;
    for (Index k = 0; k < 4; ++k) {
      const Vec3<T> a = shape.x[k], side = shape.x[k == 3 ? 0 : k + 1] - a;
      const auto out = outside(a, side, c.normal, c.p, room);
      if (!any_of(found & out)) continue;
      const auto beside = indices_of(
          [&](Index y) {
            const ExposedRow& row = geometry.table[y];
            const Index other = row.beside[k < row.count() ? k : 2];
            return other >= 0 ? other : y;
          },
          t);
      const auto beyond = geometry.row(beside);
      const Vec3<T> away = cross(beyond.normal, side);
      const T over = -slack * c.length,
              up = dot(geometry.normal(m), beyond.normal) + T(rules.opposing);
      const auto over_it = ((dot(away, c.p - a) < over) | (up > sine)) &
                           ((dot(away, c.v - a) < over) | (up < -sine));
      found = found & !(out & ((dot(c.normal, beyond.center - a) < -slack) |
                               (dot(beyond.normal, c.v - a) > slack) | over_it));
    }
    return found;
  }
  /// Is the way out of the block shorter through a face beside t? See ResolveTargets::encloses.
  /// Faces that are not exposed are left to it.
  template <class T, class Ids>
  CDEM_HD Truth<T> escapes(const VertexFace<T>& c, const Ids& t, const T& plane) const {
    Truth<T> found = plane > plane;
    for (Index k = 0; k < 4; ++k) {
      const auto beside = indices_of(
          [&](Index y) {
            const Index other = geometry.table[y].beside[k];
            return other >= 0 ? other : y;
          },
          t);
      const auto row = geometry.row(beside);
      found = found | ((dot(c.normal, row.center - c.center) < T(0.0)) &
                       (dot(row.normal, c.v - row.center) > plane));
    }
    return found;
  }
};

/// Take back, of the faces that semi-springs may begin to touch, or touch next, those that their
/// vertex passes at a rim or cannot reach in a seam.
struct DropPassedTargets : FaceSearch {
  CDEM_HD void operator()(One m) const {
    for (Index slot = 4 * m.i; slot < 4 * m.i + 4; ++slot)
      if (springs.unresolved[slot]) drop(m.i, slot);
  }
  /// Does vertex k of exposed face m pass t, or does a seam hide one from the other?
  CDEM_HD bool passes(Index m, Index k, Index t) const {
    const Index node = faces.vertex(exposed_face[m], k);
    const Vec3<Real> v = faces.nodes.position(node);
    const Vertex s{node, v, v + rules.indentation * (geometry.center(m) - v)};
    const Real near = above(t), length = smaller_length(m, t), plane = plane_gap(v, t);
    if (!opposes(m, t) || plane > near + rules.lifted || plane < -rules.depth * length - near ||
        !beside(s.p, t, rules.tolerance * length))
      return false;  // it is no target
    const Real gap = project(faces.shape(exposed_face[t]), v, geometry.normal(t)).gap;
    return hidden(m, t, gap, s) || rides(m, t, gap, s);
  }

 private:
  static constexpr Index most_around = 32;  // faces at a vertex that are looked at

  /// A vertex and its indented point.
  struct Vertex {
    Index node;
    Vec3<Real> v, p;
  };

  CDEM_HD void drop(Index m, Index slot) const {
    const bool free = springs.target_before[slot] < 0;
    for (Index c = candidates.first[slot]; c < candidates.first[slot + 1]; ++c)
      candidates.may_begin[c] =
          (!free || candidates.may_begin[c]) && !passes(m, slot - 4 * m, candidates.other[c]);
  }
  /// Does a vertex touch a face beside t, or pass it? It is hardly behind that, and less deep than
  /// behind t or opposed to m more.
  CDEM_HD bool rides(Index m, Index t, Real gap, const Vertex& s) const {
    const Vec3<Real> mother = geometry.normal(m);
    const Real opposed = dot(mother, geometry.normal(t)),
               room = rules.tolerance * smaller_length(m, t);
    return BesideRim{faces, geometry}.any(t, [&](const Vec3<Real>& center, const Vec3<Real>& n) {
      const Real up = dot(n, s.v - center);
      return up > -room && (up > gap || dot(mother, n) < opposed) && deepest(s.node, s.v, n);
    });
  }
  /// Is a contact of a vertex of exposed face m with t inside the surface that one of their blocks
  /// makes with others that lie flush?
  CDEM_HD bool hidden(Index m, Index t, Real gap, const Vertex& s) const {
    if (!flush.first || flush.meet(faces, rules, geometry.table[m], geometry.table[t]))
      return false;
    const Index face = exposed_face[m], target = exposed_face[t];
    const Vec3<Real> n = geometry.normal(t);
    if (flush.cover(faces, rules, target, s.p - plane_gap(s.p, t) * n, s.node)) return true;
    if (!flush.at_node[s.node]) return false;
    const Index spared = faces.vertex(target, 0);
    // of two parallel faces that meet in a seam the indented point chooses
    const bool left = dot(geometry.normal(m), n) < -coplanar_faces &&
                      !flush.cover(faces, rules, face, s.p, spared);
    Index f = face;
    for (Index turn = 0; turn < most_around; ++turn) {
      if (!(left && f == face) && flush.obstruct(faces, rules, f, s.v, -n, spared)) return true;
      Index side;
      const Index next = flush.next_around(faces, f, s.node, side);
      if (next < 0) return false;
      const Index end = faces.vertex(f, side + 1 == faces.vertex_count(f) ? 0 : side + 1);
      const Vec3<Real> along = faces.nodes.position(end) - s.v;
      if (is_in_foot(f, next, along, t, gap, s) || is_in_foot(next, f, along, t, gap, s))
        return true;
      if ((f = next) == face) return false;
    }
    return false;
  }
  /// Does the surface turn up at a vertex, from a face of its block to that of a body that covers
  /// another one? Of the corners in such a foot the one that is less deep touches.
  CDEM_HD bool is_in_foot(Index covered, Index own, const Vec3<Real>& along, Index t, Real gap,
                          const Vertex& s) const {
    const Index target = exposed_face[t];
    if (!flush.turns_up(faces, rules, covered, own, s.v, along, faces.vertex(target, 0)))
      return false;
    const FaceShape<Real> shape = faces.shape(own), other = faces.shape(target);
    for (Index j = 0; j < other.count(); ++j)
      if (!(dot(shape.normal(), other.x[j] - shape.center()) > gap)) return false;
    return true;
  }
};

/// Choose the target faces of the semi-springs of one exposed face.
///
/// The indented point P = v + alpha (C - v) decides which face is the target; the true vertex v
/// gives gap, weights and force. A target qualifies when it opposes the mother face, P projects
/// into it, v is behind its plane within the limit, and no exterior edge that leaves v goes deeper
/// (v is the locally deepest point). The current target is kept while the vertex is behind it,
/// whatever its edges do. A contact that has dilated acts above the plane, and is kept to twice the
/// height to which it has risen.
///
/// Some vertices penetrate deeper than a contact may begin all the same: while another target keeps
/// their spring, or beside a rim where an edge that leaves them reaches deeper, in free air. A
/// vertex that is truly inside a block may begin as deep as a contact is kept, at the nearest face
/// and whatever its edges do; like every contact that begins inside, it is free of stress there.
/// A vertex is never inside the body that bonds make of its own block and others.
struct ResolveTargets : FaceSearch {
  CDEM_HD void operator()(One m) const {
    const Flag* unresolved = springs.unresolved + 4 * m.i;
    if (!(unresolved[0] | unresolved[1] | unresolved[2] | unresolved[3])) return;
    for (Index k = 0; k < 4; ++k)
      if (unresolved[k]) resolve(m.i, k);
  }
  CDEM_HD void resolve(Index m, Index k) const {
    const Index slot = 4 * m + k;
    FaceList listed = listed_for(slot);
    listed.may_begin = candidates.may_begin + candidates.first[slot];
    springs.target[slot] = choose(m, k, listed, springs.lost + slot);
  }

  /// The faces of the inner list at the vertex of a slot.
  CDEM_HD FaceList listed_for(Index slot) const {
    const Index first = candidates.first[slot];
    return {candidates.other + first, nullptr, candidates.first[slot + 1] - first};
  }
  /// Target of vertex k of exposed face m among others, or none; `lost` is set where a loaded
  /// contact penetrated too deep.
  CDEM_HD Index choose(Index m, Index k, const FaceList& others, Flag* lost) const {
    Seeker s = start(m, k, lost);
    for (Index c = 0; c < others.count && !s.kept; ++c) {
      if (!others.takes(c)) continue;
      const Index t = others.other[c];
      if (!opposes(m, t)) continue;
      const Real near = above(t), length = smaller_length(m, t);
      const Real plane = plane_gap(s.v, t);
      if (plane > near + s.lifted || plane < -rules.depth * length - near) continue;
      if (!beside(s.p, t, rules.tolerance * length)) continue;
      // shallower contacts may begin whatever the approach
      const bool flat = geometry.is_triangle(t) && plane > -surely_shallow * rules.entry * length;
      const Real near_by = flat ? 0.0 : approach(geometry.normal(t), s.node, geometry.vertices(t));
      const Real entry = rules.entry * length + near_by + s.turn_depth;
      const bool penetration = s.free && plane < -entry && encloses(t, s, plane);
      const Real limit = penetration ? deepest_inside(t, length) : entry;
      const Real gap = qualify(m, s.node, s.v, s.p, t, {s.lifted, limit, penetration});
      if (is_better(gap, s)) {
        s.best = t;
        s.gap = gap;
      }
    }
    return s.best;
  }

 private:
  static constexpr Real none = 1e300;          // a gap that is no contact
  static constexpr Real surely_shallow = 0.9;  // part of the entry that needs no look at velocities
  static constexpr Real rim_part = 0.1;        // of its depth: so deep a vertex lies on a face
  static constexpr Index most_around = 32;     // faces at a vertex that are looked at
  static constexpr Real turn = 1.5;  // a loaded spring enters its next face by so much of its depth

  /// One vertex that seeks its target.
  struct Seeker {
    Index node, best;
    Vec3<Real> v, p;  // true vertex, indented point
    Real gap, turn_depth;
    Real lifted;  // highest gap of a contact  [m]
    bool kept;    // the current target still qualifies
    bool free;    // there was none
  };

  /// Conditions of a contact.
  struct Terms {
    Real lifted, limit;  // highest gap, and lowest below zero  [m]
    bool inside;         // it is inside the block: need not be the deepest point
  };

  CDEM_HD Seeker start(Index m, Index k, Flag* lost) const {
    const Index slot = 4 * m + k, current = springs.target_before[slot];
    Seeker s{.node = faces.vertex(exposed_face[m], k),
             .best = -1,
             .v = {},
             .p = {},
             .gap = -1e300,
             .turn_depth = 0,
             .lifted = 0,
             .kept = false,
             .free = current < 0};
    s.v = faces.nodes.position(s.node);
    s.p = s.v + rules.indentation * (geometry.center(m) - s.v);
    if (current < 0) return s;
    const ContactState state = ContactState::at(springs.state, slot);
    const bool loaded = state.force_n > 0;
    const Real length = smaller_length(m, current), stress_free_gap = state.stress_free_gap;
    const Real depth = rules.depth * length - min_of(stress_free_gap, 0.0);
    s.lifted = 2 * max_of(stress_free_gap, 0.0);
    if (qualify(m, s.node, s.v, s.p, current, {s.lifted, depth, true}) < none) {
      s.best = current;
      s.kept = true;
      return s;
    }
    const Real old_gap = plane_gap(s.v, current);
    if (loaded && old_gap < 0) s.turn_depth = -turn * old_gap;
    if (loaded && is_below(s.p, current, old_gap, depth)) *lost = 1;
    return s;
  }
  /// Down to this depth a point behind a face is not yet beyond the other side of its block.
  CDEM_HD Real deepest_inside(Index t, Real length) const {
    return min_of(rules.depth * length, 0.5 * faces.face_height[exposed_face[t]]);
  }
  /// Is a point that lies behind face t by `plane` < 0 at least as far behind the faces that bend
  /// away across its sides? Then t is where the way out of the block is shortest. A vertex of the
  /// body that bonds make of that block and others lies on a face of its own block, not inside.
  CDEM_HD bool encloses(Index t, const Seeker& s, Real plane) const {
    if (is_of_body(s.node, t)) return false;
    const Vec3<Real>& v = s.v;
    for (Index k = 0; k < faces.vertex_count(exposed_face[t]); ++k) {
      const Index across = faces.across(t, k);
      if (across < 0) continue;
      const Index exposed = faces.face_exposed[across];
      const Vec3<Real> center =
          exposed >= 0 ? geometry.center(exposed) : faces.shape(across).center();
      if (plane_gap(center, t) < 0 && dot(normal_across(faces, geometry, t, k), v - center) > plane)
        return false;
    }
    return true;
  }
  /// Is a contact at this gap the best one yet?
  CDEM_HD static bool is_better(Real gap, const Seeker& s) { return gap < none && gap > s.gap; }
  CDEM_HD bool is_of_body(Index node, Index t) const {
    return faces.body[node] == faces.body[faces.vertex(exposed_face[t], 0)];
  }
  CDEM_HD bool is_below(const Vec3<Real>& p, Index t, Real gap, Real depth) const {
    return gap < -depth && faces.shape(exposed_face[t]).inside(p, geometry.normal(t), 0.0);
  }
  /// Is a point that is not beside face t behind it all the same, between the normals of t and of
  /// the faces that rise beyond its sides, where it is beside none of them? A vertex that is
  /// pressed into a corner from inside comes there. The indented point decides between two faces
  /// that may both be the target, else the vertex itself.
  CDEM_HD bool behind_corner(Index m, Index t, const FaceShape<Real>& f, const Vec3<Real>& v,
                             const Vec3<Real>& p, const Vec3<Real>& n, Real room,
                             bool inside) const {
    for (Index k = 0; k < f.count(); ++k) {
      const Vec3<Real> a = f.x[k], side = f.x[k + 1 == f.count() ? 0 : k + 1] - a;
      if (!outside(a, side, n, p, room)) continue;
      const Index across = inside ? beyond_seam(m, t, k, a, side, p) : faces.across(t, k);
      if (across < 0 || !(inside || faces.face_exposed[across] >= 0)) return false;
      const FaceShape<Real> beyond_it = faces.shape(across);
      const Vec3<Real> u = beyond_it.normal();
      const bool rises = dot(n, beyond_it.center() - a) > 0 && !(dot(n, u) > coplanar_faces);
      const Vec3<Real>& point = dot(geometry.normal(m), u) < -rules.opposing ? p : v;
      if (!rises || dot(u, v - a) > 0 || dot(cross(u, side), point - a) < 0) return false;
    }
    return true;
  }
  /// The face beyond side k of t that a vertex of m may meet: of a block that lies flush, where one
  /// covers the face of t's own block there.
  CDEM_HD Index beyond_seam(Index m, Index t, Index k, const Vec3<Real>& start,
                            const Vec3<Real>& side, const Vec3<Real>& point) const {
    const Index across = faces.across(t, k);
    if (!flush.first || across < 0) return across;
    const Real along = dot(point - start, side) / dot(side, side);
    const Vec3<Real> foot = start + min_of(max_of(along, 0.0), 1.0) * side;
    const Index other =
        flush.beyond_cover(faces, rules, across, foot, faces.vertex(exposed_face[m], 0));
    return other >= 0 ? other : across;
  }
  /// Gap of the vertex to face t if it is in contact there on the given terms, else `none`.
  CDEM_HD Real qualify(Index m, Index node, const Vec3<Real>& v, const Vec3<Real>& p, Index t,
                       const Terms& terms) const {
    if (!opposes(m, t)) return none;
    const Vec3<Real> n = geometry.normal(t);
    const FaceShape<Real> f = faces.shape(exposed_face[t]);
    const Real room = rules.tolerance * smaller_length(m, t);
    if (!f.inside(p, n, room) && ((!terms.inside && is_of_body(node, t)) ||
                                  !behind_corner(m, t, f, v, p, n, room, terms.inside)))
      return none;
    const Real gap = project(f, v, n).gap;
    if (gap > terms.lifted || gap < -terms.limit) return none;
    for (Index j = 0; j < f.count(); ++j)
      if (faces.bonded_node[faces.vertex(exposed_face[t], j)] == faces.bonded_node[node])
        return none;
    return terms.inside || deepest(node, v, n) ? gap : none;
  }
};

}  // namespace cdem
