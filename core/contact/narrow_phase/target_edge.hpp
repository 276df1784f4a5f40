// target_edge.hpp - which edges a semi-edge crosses. Feng et al. (2014), Eq. 10-12.
#pragma once

#include <bit>

#include "core/base/parallel.hpp"
#include "core/contact/geometry/edge.hpp"
#include "core/contact/geometry/face_interfaces.hpp"
#include "core/contact/narrow_phase/closed_contact.hpp"
#include "core/contact/narrow_phase/contact_columns.hpp"
#include "core/contact/narrow_phase/edge_pair.hpp"

namespace cdem {

/// Contacts that the search finds in a step, by mother face and in any order: `slots` places a
/// face. A face may cross more edges than that; its count says so, and the caller makes room.
struct FoundEdges {
  Index slots;
  Index* count;  // [exposed]
  Index* rows;   // [exposed][slots] of FoundEdge
  bool alone;    // see raise
};

/// How many an exposed face has.
struct FoundOnFace {
  const Index* count;
  CDEM_HD Real operator()(One m) const { return count[m.i]; }
};

/// A contact of a semi-edge as it is found: a row of 3.
struct FoundEdge {
  Index mother, target;  // 4 * exposed face + side
  Index before;          // place of this contact one step ago, or -1

  CDEM_HD static FoundEdge at(const Index* rows, std::size_t place) {
    const Index* r = rows + 3 * place;
    return {r[0], r[1], r[2]};
  }
  CDEM_HD void store(Index* rows, std::size_t place) const {
    Index* r = rows + 3 * place;
    r[0] = mother, r[1] = target, r[2] = before;
  }
  /// In the order of the target faces, of the mother's sides and of the target's.
  CDEM_HD bool is_before(const FoundEdge& other) const {
    if (target / 4 != other.target / 4) return target < other.target;
    return mother != other.mother ? mother < other.mother : target < other.target;
  }
};

/// A side of an exposed face and one of another, or such a pair a lane.
template <class Ids>
struct TwoSides {
  Ids m, t;    // exposed faces
  Ids sides;   // SidePair::code
  Ids before;  // place of their contact one step ago, or -1
};

/// Find which semi-edges touch.
///
/// The indented semi-edge decides which edges it crosses; the true edges give gap and force. Of the
/// two faces at a target edge the one that opposes the mother face more is the right face (Eq. 10).
/// Edges between nearly coplanar faces are no edges; the normal must lie in both edges' cones.
struct ResolveTargetEdges {
  FaceColumns faces;
  FaceGeometry geometry;
  const Index* exposed_face;
  EdgePairs pairs;
  SearchRules rules;
  EdgesBefore held;
  Flag* lost;  // [exposed] 1: a loaded contact was lost because it penetrated too deep
  FoundEdges found;

  /// More contacts than this on one face stop the run.
  static constexpr Index most_slots = 64;

  /// From the first way that is open to the last.
  CDEM_HD Range items(Index p) const {
    const auto open = std::uint8_t(pairs.open[p]);
    const Index first = open ? std::countr_zero(open) : 0;
    return {EdgeWays::count * p + first, EdgeWays::count * p + std::bit_width(open)};
  }
  CDEM_HD bool selects(Index p, Index id) const {
    return pairs.open[p] >> (id - EdgeWays::count * p) & 1;
  }
  template <class I>
  CDEM_HD void operator()(const I& item) const {
    TwoSides<typename IndexOf<I>::type> sides;
    for_lanes(item, [&](Index lane, Index p, Index id) {
      const auto of = pairs.sides_of(p, id - EdgeWays::count * p);
      const SidePair pair{of.mother % 4, of.target % 4, of.shared};
      of_lane(sides.m, lane) = of.mother / 4;
      of_lane(sides.t, lane) = of.target / 4;
      of_lane(sides.sides, lane) = pair.code();
      of_lane(sides.before, lane) = held_place(of.mother, of.target);
    });
    const auto touch = test(sides);
    if (!any_of(touch.touches | touch.too_deep)) return;
    for_lanes(item, [&](Index lane, Index, Index) {
      const Index m = of_lane(sides.m, lane);
      if (holds(touch.too_deep, lane)) set(lost[m]);
      if (!holds(touch.touches, lane)) return;
      const SidePair pair = SidePair::of(of_lane(sides.sides, lane));
      const FoundEdge contact{4 * m + pair.k, 4 * of_lane(sides.t, lane) + pair.j,
                              of_lane(sides.before, lane)};
      const Index place = raise(found.count[m], found.alone);
      if (place < found.slots) contact.store(found.rows, std::size_t(m) * found.slots + place);
    });
  }

  /// Place of the contact that two sides (4 * exposed face + side) had one step ago, or -1.
  CDEM_HD Index held_place(Index mother, Index target) const {
    const Index m = mother / 4;
    if (held.first[m] == held.first[m + 1]) return -1;
    return held_place(m, mother % 4, edge_of(target));
  }
  CDEM_HD Index edge_of(Index side) const {
    return faces.face_edges[4 * exposed_face[side / 4] + side % 4];
  }
  CDEM_HD Index held_place(Index m, Index k, Index edge) const {
    for (Index c = held.first[m]; c < held.first[m + 1]; ++c) {
      const EdgeContact contact = EdgeContact::at(held.contact, c);
      if (contact.edge == edge && contact.mother == 4 * m + k) return c;
    }
    return -1;
  }

  template <class M>
  struct Touch {
    M touches, too_deep;  // too deep: they did touch, under load, and penetrate too deep now
  };
  /// Do two sides touch?
  template <class Ids>
  CDEM_HD auto test(const TwoSides<Ids>& pair) const {
    using T = Number<Ids>;
    using Outcome = Touch<Truth<T>>;
    const T zero(0.0), one(1.0), alpha(rules.indentation);
    const auto of_m = geometry.row(pair.m), of_t = geometry.row(pair.t);
    const Vec3<T> nm = of_m.normal, nt = of_t.normal;
    const Corners<Ids> at = corners(pair);
    const Vec3<T> xm = faces.nodes.position(at.m0), xt = faces.nodes.position(at.t0);
    const Vec3<T> dm = faces.nodes.position(at.m1) - xm, dt = faces.nodes.position(at.t1) - xt;
    const Vec3<T> p0 = xm + alpha * (of_m.center - xm);
    const auto goes_on = numbers_of([](Index before) { return before >= 0; }, pair.before) > zero;
    const T slack = select(goes_on, T(crossing_slack(rules.indentation)), zero);
    const T lifted = highest_gap(pair.before);
    const T length = min_of(abs_of(of_m.length), abs_of(of_t.length));
    Truth<T> may = (dot(nm, nt) < T(-rules.opposing)) & are_sharp<T>(pair) &
                   !far_apart(xm, dm, p0, xt, dt, nt - nm, slack, lifted) &
                   !together(pair, at, length);
    if (!any_of(may)) return Outcome{may, may};
    may = may & is_right(pair, dot(nm, nt), nm);

    const Vec3<T> n = edge_normal(dm, dt, nt - nm);
    const Crossing<T> inner = cross_edges(p0, (one - alpha) * dm, xt, dt, n);
    const auto crosses = [&](const T& place) {
      return !((place < -slack) | (place > one + slack));
    };
    const Crossing<T> edges = cross_edges(xm, dm, xt, dt, n);
    may = may & crosses(inner.s) & crosses(inner.t) & !(edges.gap > lifted) &
          cones_hold(pair, nm, nt, dm, dt, n);
    const Vec3<T> rate = velocity_at(at.m0, at.m1, edges.s) - velocity_at(at.t0, at.t1, edges.t);
    const T approach = T(rules.approach_steps * faces.dt) * abs_of(dot(n, rate));
    const T limit = select(goes_on, T(rules.depth) * length, T(rules.entry) * length + approach);
    const Truth<T> deep = edges.gap < -limit;
    const auto loaded = numbers_of(
        [&](Index before) {
          return before >= 0 && ContactState::at(held.state, before).force_n > 0;
        },
        pair.before);
    return Outcome{Truth<T>(may & !deep), Truth<T>(may & deep & (loaded > zero))};
  }

 private:
  /// Ends of both sides.
  template <class Ids>
  struct Corners {
    Ids m0, m1, t0, t1;
  };
  template <class Ids>
  CDEM_HD Corners<Ids> corners(const TwoSides<Ids>& pair) const {
    const auto start = [&](Index x, Index k) { return geometry.table[x].corner[k]; };
    const auto end = [&](Index x, Index k) { return geometry.table[x].end(k); };
    const auto m = [&](auto of) {
      return indices_of([&](Index x, Index code) { return of(x, SidePair::of(code).k); }, pair.m,
                        pair.sides);
    };
    const auto t = [&](auto of) {
      return indices_of([&](Index x, Index code) { return of(x, SidePair::of(code).j); }, pair.t,
                        pair.sides);
    };
    return {.m0 = m(start), .m1 = m(end), .t0 = t(start), .t1 = t(end)};
  }
  template <class T, class Ids>
  CDEM_HD auto are_sharp(const TwoSides<Ids>& pair) const {
    return numbers_of(
               [&](Index m, Index t, Index code) {
                 const SidePair sides = SidePair::of(code);
                 return geometry.sharp(m, sides.k) && geometry.sharp(t, sides.j);
               },
               pair.m, pair.t, pair.sides) > T(0.0);
  }
  /// Sides that start from one place in the mesh, and are still there, are not edges on each other.
  template <class T, class Ids>
  CDEM_HD Truth<T> together(const TwoSides<Ids>& pair, const Corners<Ids>& at,
                            const T& length) const {
    const Ids* mother[2] = {&at.m0, &at.m1};
    const Ids* target[2] = {&at.t0, &at.t1};
    const T near = T(rules.indentation) * length;
    Truth<T> found = near < T(0.0);
    for (Index ends = 0; ends < 4; ++ends) {
      const auto shared =
          numbers_of([&](Index code) { return SidePair::of(code).shared >> ends & 1; }, pair.sides);
      const auto share = shared > T(0.0);
      if (!any_of(share)) continue;
      const Vec3<T> d =
          faces.nodes.position(*mother[ends >> 1]) - faces.nodes.position(*target[ends & 1]);
      found = found | (share & (dot(d, d) < near * near));
    }
    return found;
  }
  /// A contact that has dilated acts at a distance, and is kept to twice the height to which it has
  /// risen  [m].
  template <class Ids, class T = Number<Ids>>
  CDEM_HD T highest_gap(const Ids& before) const {
    if (!(rules.lifted > 0)) return T(0.0);
    const auto risen = [&](Index b) {
      return b < 0 ? 0.0 : 2 * max_of(ContactState::at(held.state, b).stress_free_gap, 0.0);
    };
    return numbers_of(risen, before);
  }
  /// Most pairs are parallel, pass each other at a distance or have not met yet: the common
  /// perpendicular tells it without a root or a division, before all else. `p0` is where the
  /// indented side starts, `out` leads from the mother face to the target's and is 2 long at most.
  template <class T>
  CDEM_HD Truth<T> far_apart(const Vec3<T>& xm, const Vec3<T>& dm, const Vec3<T>& p0,
                             const Vec3<T>& xt, const Vec3<T>& dt, const Vec3<T>& out,
                             const T& slack, const T& lifted) const {
    constexpr Real parallel = parallel_edges;
    const Vec3<T> c = cross(dm, dt);
    const T c2 = dot(c, c);
    return (c2 < T(parallel * parallel) * dot(dm, dm) * dot(dt, dt)) |
           (dot(xt - xm, c) * dot(c, out) < T(-2.0) * lifted * c2) |
           crosses_beyond(p0, dm, xt, dt, c, c2, rules, slack);
  }
  template <class Ids, class T>
  CDEM_HD Vec3<T> velocity_at(const Ids& a, const Ids& b, const T& s) const {
    const Vec3<T> va = faces.nodes.velocity(a);
    return va + s * (faces.nodes.velocity(b) - va);
  }
  /// -n in the mother edge's normal cone, n in the target edge's: the faces at an edge fall away
  /// from the contact plane.
  template <class Ids, class T>
  CDEM_HD Truth<T> cones_hold(const TwoSides<Ids>& pair, const Vec3<T>& nm, const Vec3<T>& nt,
                              const Vec3<T>& dm, const Vec3<T>& dt, const Vec3<T>& n) const {
    const auto k = indices_of([](Index code) { return SidePair::of(code).k; }, pair.sides);
    const auto j = indices_of([](Index code) { return SidePair::of(code).j; }, pair.sides);
    const T zero(0.0), slack2(rules.cone * rules.cone);
    // does the face with this normal, which leaves the edge to the left of `along`, rise along
    // `way` by more than the slack (a sine)? Without a root or a division.
    const auto rises = [&](const Vec3<T>& normal, const Vec3<T>& along, const Vec3<T>& way) {
      const Vec3<T> into = cross(normal, along);
      const T up = dot(way, into);
      return (up > zero) & (up * up > slack2 * dot(into, into));
    };
    // 0 where there is no face across, which does not rise
    const Vec3<T> beyond_m = normal_across(faces, geometry, pair.m, k);
    const Vec3<T> beyond_t = normal_across(faces, geometry, pair.t, j);
    return !(rises(nm, dm, -n) | rises(nt, dt, n) | rises(beyond_m, -dm, -n) |
             rises(beyond_t, -dt, n));
  }
  /// Is exposed face t the right face of its side for the mother face: does the one across that
  /// side oppose it less? `here` is the product of their normals.
  template <class Ids, class T>
  CDEM_HD Truth<T> is_right(const TwoSides<Ids>& pair, const T& here, const Vec3<T>& nm) const {
    const auto other = indices_of(
        [&](Index x, Index code) {
          const Index beside = geometry.table[x].beside[SidePair::of(code).j];
          return beside >= 0 ? beside : x;
        },
        pair.t, pair.sides);
    const auto first = numbers_of([](Index y, Index x) { return x <= y; }, other, pair.t);
    const T there = dot(nm, geometry.normal(other));
    return (here < there) | ((first > T(0.0)) & !(here > there));
  }
};

/// List the contacts found for one exposed face, in order: they go on or begin. Energy that the
/// springs of ended contacts did not give back is lost to friction and dashpot.
struct ListEdgeContacts {
  ResolveTargetEdges touch;
  FaceInterfaces interfaces;
  const Index* first;  // [exposed + 1] of the list
  Index* contact;      // rows of EdgeContact
  Real* friction;      // [exposed] lost so far  [J]
  Real* dashpot;       // [exposed] lost so far  [J]

  CDEM_HD void operator()(One m) const {
    const EdgesBefore& held = touch.held;
    const FoundEdges& found = touch.found;
    Index* row = found.rows + 3 * std::size_t(m.i) * found.slots;
    sort(row, found.count[m.i]);
    for (Index j = 0; j < found.count[m.i]; ++j) {
      const FoundEdge edge = FoundEdge::at(row, j);
      EdgeContact{.mother = edge.mother,
                  .face = edge.target / 4,
                  .edge = touch.edge_of(edge.target),
                  .before = edge.before}
          .store(contact, first[m.i] + j);
    }
    for (Index c = held.first[m.i]; c < held.first[m.i + 1]; ++c) {
      bool goes_on = false;
      for (Index j = 0; j < found.count[m.i]; ++j)
        goes_on = goes_on || FoundEdge::at(row, j).before == c;
      if (goes_on) continue;
      const DissipatedAtEnd lost = lost_at_end(c);
      friction[m.i] += lost.friction;
      dashpot[m.i] += lost.dashpot;
    }
  }

 private:
  CDEM_HD static void sort(Index* row, Index count) {
    for (Index j = 1; j < count; ++j) {
      const FoundEdge edge = FoundEdge::at(row, j);
      Index place = j;
      for (; place > 0 && edge.is_before(FoundEdge::at(row, place - 1)); --place)
        FoundEdge::at(row, place - 1).store(row, place);
      edge.store(row, place);
    }
  }
  CDEM_HD DissipatedAtEnd lost_at_end(Index c) const {
    const FaceColumns& faces = touch.faces;
    const FaceGeometry& geometry = touch.geometry;
    const EdgeContact contact = EdgeContact::at(touch.held.contact, c);
    const Index m = contact.mother / 4, k = contact.mother % 4;
    const Vec3<Real> out = geometry.normal(contact.face) - geometry.normal(m);
    const Index* target = faces.edge_nodes + 2 * contact.edge;
    const Side mother = side(geometry.table[m].corner[k], geometry.table[m].end(k)),
               crossed = side(target[0], target[1]);
    const Vec3<Real> n = edge_normal(mother.along, crossed.along, out);
    const Crossing<Real> at = cross_edges(mother.x, mother.along, crossed.x, crossed.along, n);
    const Real returned =
        interfaces.returned_n(interfaces.between(geometry.table, m, contact.face));
    return {ContactState::at(touch.held.state, c), returned, edge_frame(n, crossed.along),
            mother.way(at.s) - crossed.way(at.t)};
  }
  /// An edge one step ago, and how its ends have moved since.
  struct Side {
    Vec3<Real> x, along, way0, way1;
    CDEM_HD Vec3<Real> way(Real s) const { return way0 + s * (way1 - way0); }
  };
  CDEM_HD Side side(Index a, Index b) const {
    const FaceColumns& faces = touch.faces;
    const Vec3<Real> x = faces.position_before(a);
    return {.x = x,
            .along = faces.position_before(b) - x,
            .way0 = faces.dt * faces.nodes.velocity(a),
            .way1 = faces.dt * faces.nodes.velocity(b)};
  }
};

}  // namespace cdem
