// target_edge.hpp - which edges a semi-edge crosses. Feng et al. (2014), Eq. 10-12.
#pragma once

#include "core/contact/target_face.hpp"

namespace cdem {

/// A contact of a semi-edge, as it is kept: a row of 4.
struct EdgeContact {
  Index mother;  // 4 * exposed face + side
  Index face;    // exposed face to which the target edge belongs
  Index edge;    // target edge
  Index before;  // place of this contact one step ago, or -1

  CDEM_HD static EdgeContact at(const Index* rows, std::size_t place) {
    const Index* r = rows + 4 * place;
    return {r[0], r[1], r[2], r[3]};
  }
  CDEM_HD void store(Index* rows, std::size_t place) const {
    Index* r = rows + 4 * place;
    r[0] = mother, r[1] = face, r[2] = edge, r[3] = before;
  }
};

/// The semi-edge contacts, in the order of their mother faces: first[m] to first[m + 1] are those
/// of exposed face m.
struct EdgeColumns {
  const Index* first;    // [exposed + 1]
  const Index* contact;  // rows of EdgeContact
  Real* state;           // rows of ContactState
  Real* reaction;  // rows of 8: force on the mother x y z, stiffness, place on the mother side
                   // (0..1), place on the target's side (0..1), what friction and dashpot
                   // took in the step  [J]
};

/// The same one step ago.
struct EdgesBefore {
  const Index* first;
  const Index* contact;
  const Real* state;
};

/// What the search finds in a step: `slots` places a face. A face may cross more edges than that;
/// its count says so, and the caller makes room.
struct FoundEdges {
  Index slots;
  Index* count;  // [exposed]
  Index* rows;   // [exposed][slots] of EdgeContact
};

/// Pairs of sides of exposed faces that may cross before the next refresh, in both directions.
struct EdgeCandidates {
  const Index* first;  // [exposed + 1]
  const Index* face;   // exposed face to which the target side belongs, ascending in a row
  const Index* edge;   // target edge
  const Index* sides;  // SidePair::code
  const Index* edges;  // pair of edges that the sides are of
  const Flag* near;    // [pair of edges] 0: they cannot begin to touch in this step
};

/// Side k of the mother and side j of the target. Bit 2 a + b of `shared`: end a of the one and end
/// b of the other began at the same place in the mesh.
struct SidePair {
  Index k, j, shared;
  CDEM_HD Index code() const { return shared << 4 | k << 2 | j; }
  CDEM_HD static SidePair of(Index code) { return {code >> 2 & 3, code & 3, code >> 4}; }
};

/// Where x_m + s d_m and x_t + t d_t are closest along a direction: x_m(s) - x_t(t) = gap * way.
template <class T>
struct Crossing {
  T s, t, gap;
};

template <class T>
CDEM_HD inline Crossing<T> cross_edges(const Vec3<T>& start_m, const Vec3<T>& along_m,
                                       const Vec3<T>& start_t, const Vec3<T>& along_t,
                                       const Vec3<T>& way) {
  const Vec3<T> apart = start_t - start_m;
  const Vec3<T> c = cross(along_m, along_t);
  const T det = dot(c, way);
  return {dot(cross(apart, along_t), way) / det, dot(cross(apart, along_m), way) / det,
          -dot(c, apart) / det};
}

/// Normal of an edge pair, V_mm x V_tt of Eq. 12, on the side of `out`. Any other, e.g. the normal
/// of faces that are nearly flush, makes or loses energy: only along the common perpendicular is
/// the gap's rate the velocity of the two points of the crossing.
template <class T>
CDEM_HD inline Vec3<T> edge_normal(const Vec3<T>& along_m, const Vec3<T>& along_t,
                                   const Vec3<T>& out) {
  const Vec3<T> c = unit(cross(along_m, along_t));
  return select(dot(c, out) < T(0.0), -c, c);
}

/// Tangents of an edge pair: along the target edge, and across.
template <class T>
CDEM_HD inline Frame<T> edge_frame(const Vec3<T>& n, const Vec3<T>& along_t) {
  const Vec3<T> t1 = unit(along_t - dot(n, along_t) * n);
  return {n, t1, cross(n, t1)};
}

/// Mark the pairs of edges that may begin to touch in this step. One test stands for the sides of
/// all faces at both edges, in either direction, and has room for what distinguishes them: their
/// indentation and the rate of approach. So what is found in contact does not depend on it.
struct MarkNearEdges {
  InMotion nodes;
  InIndices ends;  // [4][pair]: of one edge, and of the other
  InTable room;    // [3][pair]: depth at which a contact may begin, indentation  [m]; side on
                   // which one edge must be of the other, along the cross product: 1, -1, 0: either
  Real reach_time;  // how far the approach of how long counts as depth  [s]
  Flag* near;

  static constexpr Real parallel = 0.02;    // sine of the angle between edges that never touch
  static constexpr Real round_off = 1e-16;  // of a gap, squared, in parts of the depth

  template <class I>
  CDEM_HD void operator()(I p) const {
    using T = Number<I>;
    const auto a0 = ends.at(0, p), a1 = ends.at(1, p), b0 = ends.at(2, p), b1 = ends.at(3, p);
    const Vec3<T> start_a = nodes.position(a0), start_b = nodes.position(b0);
    const Vec3<T> along_a = nodes.position(a1) - start_a, along_b = nodes.position(b1) - start_b;
    const Vec3<T> c = cross(along_a, along_b), apart = start_b - start_a;
    const T c2 = dot(c, c), a2 = dot(along_a, along_a), b2 = dot(along_b, along_b);
    const T gap = dot(c, apart);  // times |c|
    const Vec3<T> va = nodes.velocity(a0), vb = nodes.velocity(b0);
    const T rate = size(va - vb) + size(nodes.velocity(a1) - va) + size(nodes.velocity(b1) - vb);
    const T depth = room.at(0, p) + T(reach_time) * rate, shift = room.at(1, p);
    const T off_a = outside(dot(cross(apart, along_b), c), c2);  // times |c|^2 / |along_a|
    const T off_b = outside(dot(cross(apart, along_a), c), c2);
    const T deep2 = gap * gap, depth2 = depth * depth * c2;
    const auto far = (c2 < T(parallel * parallel) * a2 * b2) | (deep2 > depth2) |
                     ((room.at(2, p) * gap < T(0.0)) & (deep2 > T(round_off) * depth2)) |
                     (off_a * off_a > shift * shift * b2 * c2) |
                     (off_b * off_b > shift * shift * a2 * c2);
    set_flags(near, p, !far);
  }

 private:
  /// Not less than the length of a vector.
  template <class T>
  CDEM_HD static T size(const Vec3<T>& v) {
    return abs_of(v.x) + abs_of(v.y) + abs_of(v.z);
  }
  /// By how much a number lies outside 0..most.
  template <class T>
  CDEM_HD static T outside(T number, T most) {
    return max_of(max_of(-number, number - most), T(0.0));
  }
};

/// Find the target edges of every semi-edge of one exposed face.
///
/// The indented semi-edge decides which edges it crosses; the true edges give gap and force. Of the
/// two faces at a target edge the one that opposes the mother face more is the right face (Eq. 10).
/// Edges between nearly coplanar faces are no edges; the normal must lie in both edges' cones.
struct FindTargetEdges {
  FaceColumns faces;
  FaceGeometry geometry;
  const Index* exposed_face;
  EdgeCandidates candidates;
  SearchRules rules;
  EdgesBefore held;
  Flag* lost;  // [exposed] 1: a loaded contact was lost because it sank too deep
  FoundEdges found;

  /// More contacts than this on one face stop the run.
  static constexpr Index most_slots = 64;

  CDEM_HD void operator()(One m) const {
    Index used = 0;
    for (Index c = candidates.first[m.i]; c < candidates.first[m.i + 1]; ++c) {
      const bool near = candidates.near[candidates.edges[c]];
      if (!near && held.first[m.i] == held.first[m.i + 1]) continue;
      const SidePair pair = SidePair::of(candidates.sides[c]);
      const Index edge = candidates.edge[c], old = held_place(m.i, pair.k, edge);
      if (!near && old < 0) continue;
      const Index t = candidates.face[c];
      if (!touches(m.i, t, pair, old >= 0, loaded(old), lost + m.i)) continue;
      if (used < found.slots)
        EdgeContact{4 * m.i + pair.k, t, edge, old}.store(found.rows,
                                                          std::size_t(m.i) * found.slots + used);
      ++used;
    }
    found.count[m.i] = used;
  }

  /// Does a side of exposed face m touch one of exposed face t?
  CDEM_HD bool touches(Index m, Index target, const SidePair& pair, bool goes_on, bool loaded,
                       Flag* sank) const {
    const Index k = pair.k, j = pair.j;
    if (!geometry.sharp(m, k) || !geometry.sharp(target, j)) return false;
    const Vec3<Real> nm = geometry.normal(m), nt = geometry.normal(target);
    if (dot(nm, nt) >= -rules.opposing || !is_right(m, target, j)) return false;
    const Sides p = sides(m, k, target, j);
    if (pair.shared && together(p, pair.shared)) return false;
    const Vec3<Real> p0 = p.xm + rules.indentation * (geometry.center(m) - p.xm);
    const Real slack = goes_on ? 0.5 * rules.indentation : 0.0;
    if (far_apart(p, p0, nm, nt, slack)) return false;

    const Vec3<Real> n = edge_normal(p.dm, p.dt, nt - nm);
    const Crossing<Real> inner = cross_edges(p0, (1.0 - rules.indentation) * p.dm, p.xt, p.dt, n);
    if (inner.s < -slack || inner.s > 1.0 + slack) return false;
    if (inner.t < -slack || inner.t > 1.0 + slack) return false;

    const Crossing<Real> true_edges = cross_edges(p.xm, p.dm, p.xt, p.dt, n);
    if (true_edges.gap > 0) return false;
    const Real approach = rules.approach_steps * faces.dt *
                          abs_of(dot(n, velocity_at(p.m0, p.m1, true_edges.s) -
                                            velocity_at(p.t0, p.t1, true_edges.t)));
    const Real limit = goes_on ? rules.depth * p.length : rules.entry * p.length + approach;
    const bool in_cones = cones_hold(m, k, target, j, p.dm, p.dt, n);
    if (true_edges.gap < -limit) {
      if (goes_on && loaded && in_cones) *sank = 1;
      return false;
    }
    return in_cones;
  }

 private:
  /// Place of the contact that side k of exposed face m had with an edge one step ago, or -1.
  CDEM_HD Index held_place(Index m, Index k, Index edge) const {
    for (Index c = held.first[m]; c < held.first[m + 1]; ++c) {
      const EdgeContact contact = EdgeContact::at(held.contact, c);
      if (contact.edge == edge && contact.mother == 4 * m + k) return c;
    }
    return -1;
  }
  CDEM_HD bool loaded(Index place) const {
    return place >= 0 && ContactState::at(held.state, place).force_n > 0;
  }
  /// A side of the mother and one of the target: nodes, start, vector; L of the smaller face.
  struct Sides {
    Index m0, m1, t0, t1;
    Vec3<Real> xm, dm, xt, dt;
    Real length;
  };
  CDEM_HD Sides sides(Index m, Index k, Index t, Index j) const {
    const Index face_m = exposed_face[m], face_t = exposed_face[t];
    Sides p;
    p.m0 = faces.vertex(face_m, k), p.m1 = faces.vertex(face_m, next(face_m, k));
    p.t0 = faces.vertex(face_t, j), p.t1 = faces.vertex(face_t, next(face_t, j));
    p.xm = faces.nodes.position(p.m0), p.xt = faces.nodes.position(p.t0);
    p.dm = faces.nodes.position(p.m1) - p.xm, p.dt = faces.nodes.position(p.t1) - p.xt;
    p.length = min_of(faces.face_length[face_m], faces.face_length[face_t]);
    return p;
  }
  /// Sides that start from one place in the mesh, and are still there, are not edges on each other.
  CDEM_HD bool together(const Sides& p, Index shared) const {
    const Real near = rules.indentation * p.length;
    const Index mother[2] = {p.m0, p.m1}, target[2] = {p.t0, p.t1};
    for (Index pair = 0; pair < 4; ++pair) {
      if (!(shared >> pair & 1)) continue;
      const Vec3<Real> d =
          faces.nodes.position(mother[pair >> 1]) - faces.nodes.position(target[pair & 1]);
      if (dot(d, d) < near * near) return true;
    }
    return false;
  }
  /// Most pairs are parallel, pass each other far off or have not met yet: see it from the common
  /// perpendicular, without a root or a division, before all else. `p0` is where the indented side
  /// starts.
  CDEM_HD bool far_apart(const Sides& p, const Vec3<Real>& p0, const Vec3<Real>& nm,
                         const Vec3<Real>& nt, Real slack) const {
    constexpr Real parallel = MarkNearEdges::parallel;
    const Vec3<Real> c = cross(p.dm, p.dt), apart = p.xt - p0;
    const Real c2 = dot(c, c);
    if (c2 < parallel * parallel * dot(p.dm, p.dm) * dot(p.dt, p.dt)) return true;
    if (dot(p.xt - p.xm, c) * dot(c, nt - nm) < 0) return true;
    const Real room = slack + 1e-9;  // for round-off
    const Real s = dot(cross(apart, p.dt), c), t = dot(cross(apart, p.dm), c);
    const Real longest = (1.0 - rules.indentation) * c2;
    return s < -room * c2 || s > longest + room * c2 || t < -room * c2 || t > (1.0 + room) * c2;
  }
  CDEM_HD Index next(Index face, Index k) const {
    return k + 1 == faces.vertex_count(face) ? 0 : k + 1;
  }
  CDEM_HD Vec3<Real> velocity_at(Index a, Index b, Real s) const {
    const Vec3<Real> va = faces.nodes.velocity(a);
    return va + s * (faces.nodes.velocity(b) - va);
  }
  /// -n in the mother edge's normal cone, n in the target edge's: the faces at an edge fall away
  /// from the contact plane.
  CDEM_HD bool cones_hold(Index m, Index k, Index t, Index j, const Vec3<Real>& dm,
                          const Vec3<Real>& dt, const Vec3<Real>& n) const {
    const Index across_m = faces.across(m, k), across_t = faces.across(t, j);
    const Vec3<Real> nm = geometry.normal(m), nt = geometry.normal(t);
    if (dot(n, unit(cross(nm, dm))) < -rules.cone) return false;
    if (dot(n, unit(cross(nt, dt))) > rules.cone) return false;
    if (across_m >= 0) {
      const Vec3<Real> n2 = normal_of(faces, geometry, across_m);
      if (dot(n, unit(cross(n2, -dm))) < -rules.cone) return false;
    }
    if (across_t >= 0) {
      const Vec3<Real> n2 = normal_of(faces, geometry, across_t);
      if (dot(n, unit(cross(n2, -dt))) > rules.cone) return false;
    }
    return true;
  }
  /// Is exposed face t the right face of its side j for mother face m: does the one across that
  /// side oppose m less?
  CDEM_HD bool is_right(Index m, Index t, Index j) const {
    const Index across = faces.across(t, j);
    const Index other = across >= 0 ? faces.face_exposed[across] : -1;
    if (other < 0) return true;
    const Vec3<Real> nm = geometry.normal(m);
    const Real here = dot(nm, geometry.normal(t)), there = dot(nm, geometry.normal(other));
    return here < there || (here == there && exposed_face[t] < across);
  }
};

/// List what was found for one exposed face: its contacts go on or begin, and what the springs of
/// those that ended did not give back is lost to friction and dashpot.
struct ListEdges {
  EdgesBefore held;
  FoundEdges found;
  const Index* first;  // [exposed + 1] of the list
  Index* contact;      // rows of EdgeContact
  Real* friction;      // [exposed] lost so far  [J]
  Real* dashpot;       // [exposed] lost so far  [J]

  CDEM_HD void operator()(One m) const {
    const std::size_t row = std::size_t(m.i) * found.slots;
    for (Index j = 0; j < found.count[m.i]; ++j)
      EdgeContact::at(found.rows, row + j).store(contact, first[m.i] + j);
    for (Index c = held.first[m.i]; c < held.first[m.i + 1]; ++c) {
      bool goes_on = false;
      for (Index j = 0; j < found.count[m.i]; ++j)
        goes_on = goes_on || EdgeContact::at(found.rows, row + j).before == c;
      if (goes_on) continue;
      const ContactState s = ContactState::at(held.state, c);
      friction[m.i] += s.energy_s;
      dashpot[m.i] += s.energy_n - 0.5 * s.force_n * max_of(s.sunk, 0.0);
    }
  }
};

}  // namespace cdem
