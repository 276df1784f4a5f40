// edge_pair.hpp - pairs of edges of the inner list, and in which ways they may touch in a step.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"
#include "core/contact/narrow_phase/contact_columns.hpp"
#include "core/contact/narrow_phase/edge_ways.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// Pairs of edges of the inner list, see pair_list/prune.hpp.
struct EdgePairs {
  InIndices ends;   // [4][pair]: of one edge, and of the other; if any of them began at the same
                    // place in the mesh, then the first of both
  InIndices sides;  // [4][pair]: 4 * exposed face + side, of the faces at the one, and at the
                    // other; the same twice where there is one
  InIndices code;   // [1][pair]: see EdgeWays
  InIndices edges;  // [2][pair]: the one, and the other
  Flag* open;       // [pair] ways in which they may touch in this step, see FilterEdgePairs
  Index* held;      // [4][pair]: place of the contact of a side as the mother with the other edge,
                    // among the contacts of one step ago, or -1
  Index stride;     // of them all

  template <class Ids>
  CDEM_HD TwoEdges<Ids> at(const Ids& p) const {
    TwoEdges<Ids> pair;
    for (Index e = 0; e < 2; ++e)
      for (Index i = 0; i < 2; ++i) {
        pair.end[e][i] = ends.at(2 * e + i, p);
        pair.side[e][i] = sides.at(2 * e + i, p);
      }
    pair.code = code.at(0, p);
    for (Index side = 0; side < 4; ++side) pair.before[side] = InIndices{held, stride}.at(side, p);
    return pair;
  }
  CDEM_HD Index place_held(Index side, Index p) const { return side * stride + p; }
  /// The mother's side and the target's: 4 * exposed face + side.
  CDEM_HD Index mother(Index p, Index way) const { return sides.at(EdgeWays::mother(way), p); }
  CDEM_HD Index target(Index p, Index way) const { return sides.at(EdgeWays::target(way), p); }
};

/// Find the old contacts of pairs of edges that do not know them from the last step.
struct FindHeldEdges {
  EdgePairs pairs;
  EdgesBefore held;
  bool known;

  CDEM_HD Range items(Index p) const { return {p, p + 1}; }
  CDEM_HD bool selects(Index, Index p) const {
    return !known || EdgeWays::have_others(pairs.code.at(0, p));
  }
  template <class I>
  CDEM_HD void operator()(const I& item) const {
    for_lanes(item, [&](Index, Index, Index p) {
      for (Index side = 0; side < 4; ++side)
        pairs.held[pairs.place_held(side, p)] =
            held.place_of(pairs.sides.at(side, p), pairs.edges.at(1 - side / 2, p));
    });
  }
};

/// Recall it where they do.
struct RecallHeldEdges {
  const Index* seen;  // [contact of one step ago], see ListEdgeContacts
  Index* held;        // of EdgePairs; -1 in all places
  CDEM_HD void operator()(One c) const { held[seen[c.i]] = c.i; }
};

/// Do an indented side from `p0` and a target side, seen along c = dm x dt, cross beyond either by
/// more than `slack` (in parts of them)? Without a root or a division.
template <class T>
CDEM_HD inline Truth<T> crosses_beyond(const Vec3<T>& p0, const Vec3<T>& dm, const Vec3<T>& xt,
                                       const Vec3<T>& dt, const Vec3<T>& c, const T& c2,
                                       const SearchRules& rules, const T& slack) {
  const Vec3<T> apart = xt - p0;
  const T s = dot(cross(apart, dt), c), t = dot(cross(apart, dm), c);
  const T room = (slack + T(1e-9)) * c2;  // for round-off
  return (s < -room) | (s > T(1.0 - rules.indentation) * c2 + room) | (t < -room) | (t > c2 + room);
}

/// Filter the ways in which near edges may touch: most do not cross where the mother's is indented,
/// or are on the wrong side of each other. The common perpendicular tells it for all ways at once,
/// without a root or a division. The others are left to ResolveTargetEdges. Its tests are the same
/// without the room that these have, so no contact depends on the filter.
struct FilterEdgePairs {
  InMotion nodes;
  FaceGeometry geometry;
  EdgePairs pairs;
  SearchRules rules;

  template <class I>
  CDEM_HD void operator()(I p) const {
    using T = Number<I>;
    const Edges<T> edges = edges_of<T>(p);
    const auto code = pairs.code.at(0, p);
    AtSide<T> at[2][2];
    Truth<T> neighbours[2];
    for (Index e = 0; e < 2; ++e) {
      for (Index i = 0; i < 2; ++i) at[e][i] = at_side(p, edges, code, e, i);
      neighbours[e] = EdgeWays::are_neighbours(code, e);
      share_cones(neighbours[e], at[e][0], at[e][1]);
    }
    const T together2 = distance_of_shared_ends(edges, code);
    T opposed[2][2];
    for (Index i = 0; i < 2; ++i)
      for (Index j = 0; j < 2; ++j) opposed[i][j] = dot(at[0][i].normal, at[1][j].normal);
    unsigned open[EdgeWays::count];  // lane by lane, as bits
    for (Index i = 0; i < 2; ++i)
      for (Index j = 0; j < 2; ++j) {
        const AtSide<T>&a = at[0][i], &b = at[1][j];
        const T here = opposed[i][j] - T(1e-9);
        const T near = T(0.999999 * rules.indentation) * min_of(a.length, b.length);
        const auto wrong = edges.parallel | (together2 < near * near) |
                           !(here < T(-rules.opposing)) | are_apart(edges, a, b);
        // of two faces at a target edge that which opposes the mother less is not the right one
        const auto left_a = neighbours[0] & (here > opposed[1 - i][j]);
        const auto left_b = neighbours[1] & (here > opposed[i][1 - j]);
        open[EdgeWays::way(false, i, j)] = lane_bits(!(wrong | a.far | left_b));
        open[EdgeWays::way(true, i, j)] = lane_bits(!(wrong | b.far | left_a));
      }
    for_lanes(p, [&](Index lane, Index pair) {
      Index some = 0;
      for (Index way = 0; way < EdgeWays::count; ++way) some |= (open[way] >> lane & 1) << way;
      pairs.open[pair] = Flag(some & of_lane(code, lane));
    });
  }

 private:
  template <class T>
  struct Edges {
    Vec3<T> x[2], d[2];  // where they begin, and to where they end  [m]
    Vec3<T> c;           // d[0] x d[1]
    T c2, apart;         // |c|^2; from the first to the second along c, times |c|
    T room;              // for round-off and lift of `apart` times what normals differ along c
    Truth<T> parallel;
  };
  /// Decisions by a face at an edge.
  template <class T>
  struct AtSide {
    Vec3<T> normal;
    T along, length;        // the normal along c; L  [m]
    Truth<T> far;           // as the mother it does not cross the other edge
    Truth<T> rises, falls;  // by more than the slack of the cones, along c, along -c
  };
  template <class T, class I>
  CDEM_HD Edges<T> edges_of(I p) const {
    const auto end = [&](Index k) { return nodes.position(pairs.ends.at(k, p)); };
    Edges<T> of;
    for (Index e = 0; e < 2; ++e) of.x[e] = end(2 * e), of.d[e] = end(2 * e + 1) - of.x[e];
    const Vec3<T>*x = of.x, *d = of.d;
    of.c = cross(d[0], d[1]);
    of.c2 = dot(of.c, of.c);
    of.apart = dot(x[1] - x[0], of.c);
    // of a gap, times |c| twice: below it ResolveTargetEdges decides on which side it is
    const T round_off = T(1e-12) * of.c2 * (abs_of(d[0].x) + abs_of(d[0].y) + abs_of(d[0].z));
    of.room = round_off + T(2.0 * rules.lifted) * of.c2;  // the normals differ by 2 at most
    of.parallel = of.c2 < T(parallel_edges * parallel_edges) * dot(d[0], d[0]) * dot(d[1], d[1]);
    return of;
  }
  template <class I, class T, class Ids>
  CDEM_HD AtSide<T> at_side(I p, const Edges<T>& edges, const Ids& code, Index e, Index i) const {
    const T none(0.0), steepest(rules.filter_room * rules.cone * rules.cone);
    const auto face = indices_of([](Index side) { return side / 4; }, pairs.sides.at(2 * e + i, p));
    const auto of = geometry.row(face);
    const Vec3<T>&x = edges.x[e], &d = edges.d[e], c = e == 0 ? edges.c : -edges.c;
    const auto held = InIndices{pairs.held, pairs.stride}.at(2 * e + i, p);
    const T slack =
        select(is_none(held), none, T(rules.filter_room * crossing_slack(rules.indentation)));
    const Vec3<T> start = x + T(rules.indentation) * (of.center - x);
    const Vec3<T> into = cross(of.normal, d);
    const T forward = dot(edges.c, into);
    const T up = select(EdgeWays::runs_against(code, e, i), -forward, forward);
    const auto steep = up * up > steepest * dot(into, into) * edges.c2;
    return {.normal = of.normal,
            .along = dot(edges.c, of.normal),
            .length = abs_of(of.length),
            .far = crosses_beyond(start, d, edges.x[1 - e], edges.d[1 - e], c, edges.c2, rules,
                                  slack + T(1e-9)),
            .rises = Truth<T>(steep & (up > none)),
            .falls = Truth<T>(steep & (up < none))};
  }
  /// Of two faces on either side of an edge none may rise.
  template <class T>
  CDEM_HD static void share_cones(const Truth<T>& neighbours, AtSide<T>& one, AtSide<T>& other) {
    const Truth<T> rise = neighbours & (one.rises | other.rises);
    const Truth<T> fall = neighbours & (one.falls | other.falls);
    one.rises = one.rises | rise, other.rises = other.rises | rise;
    one.falls = one.falls | fall, other.falls = other.falls | fall;
  }
  /// Are they on the wrong side of each other, or the normal in one of the cones not?
  template <class T>
  CDEM_HD static Truth<T> are_apart(const Edges<T>& edges, const AtSide<T>& a, const AtSide<T>& b) {
    const T out = b.along - a.along, flat = T(1e-9) * (abs_of(b.along) + abs_of(a.along));
    return (edges.apart * out < -edges.room) | ((out > flat) & (a.falls | b.rises)) |
           ((out < -flat) & (a.rises | b.falls));
  }
  /// Squared distance of the ends that began at one place, or very far: both first ones, or both
  /// last ones, as nearly all are.
  template <class T, class Ids>
  CDEM_HD static T distance_of_shared_ends(const Edges<T>& edges, const Ids& code) {
    const Vec3<T>*x = edges.x, *d = edges.d;
    const T far(1e300);
    T least = far;
    for (Index end = 0; end < 2; ++end) {
      const Vec3<T> apart = end == 0 ? x[1] - x[0] : (x[1] + d[1]) - (x[0] + d[0]);
      const auto share = EdgeWays::share(code, end, end);
      least = min_of(least, select(share, dot(apart, apart), far));
    }
    return least;
  }
};

}  // namespace cdem
