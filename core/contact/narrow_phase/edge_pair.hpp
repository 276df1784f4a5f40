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
                    // among those of one step ago, or -1
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

/// Find what pairs of edges held one step ago, where they do not know it from that step.
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
    const auto end = [&](Index k) { return nodes.position(pairs.ends.at(k, p)); };
    const Vec3<T> x[2] = {end(0), end(2)}, d[2] = {end(1) - x[0], end(3) - x[1]};
    const Vec3<T> c = cross(d[0], d[1]);
    const T c2 = dot(c, c), apart = dot(x[1] - x[0], c);
    // of a gap, times |c| twice: below it ResolveTargetEdges decides on which side it is
    const T round_off = T(1e-12) * c2 * (abs_of(d[0].x) + abs_of(d[0].y) + abs_of(d[0].z));
    const T room = round_off + T(2.0 * rules.lifted) * c2;  // the normals differ by 2 at most
    const T none(0.0);
    const auto code = pairs.code.at(0, p);
    const T steepest(1.000001 * rules.cone * rules.cone);
    Vec3<T> normal[2][2];
    T along[2][2], length[2][2];  // along c; L  [m]
    Truth<T> far[2][2];
    Truth<T> rises[2][2], falls[2][2], neighbours[2];
    for (Index e = 0; e < 2; ++e) {
      for (Index i = 0; i < 2; ++i) {
        const auto side = pairs.sides.at(2 * e + i, p);
        const auto face = indices_of([](Index s) { return s / 4; }, side);
        const auto of = geometry.row(face);
        normal[e][i] = of.normal;
        length[e][i] = abs_of(of.length);
        along[e][i] = dot(c, of.normal);
        const Vec3<T> start = x[e] + T(rules.indentation) * (of.center - x[e]);
        const auto beyond = [&](const T& slack) {
          return crosses_beyond(start, d[e], x[1 - e], d[1 - e], e == 0 ? c : -c, c2, rules,
                                slack + T(1e-9));
        };
        const auto goes_on =
            numbers_of([](Index c) { return c >= 0; },
                       InIndices{pairs.held, pairs.stride}.at(2 * e + i, p)) > none;
        far[e][i] = beyond(select(goes_on, T(1.000001 * crossing_slack(rules.indentation)), none));
        // does the face rise along c, along -c, by more than the slack of the cones?
        const Vec3<T> into = cross(of.normal, d[e]);
        const T up =
            dot(c, into) * numbers_of([&](Index of) { return EdgeWays::sense(of, e, i); }, code);
        const auto steep = up * up > steepest * dot(into, into) * c2;
        rises[e][i] = steep & (up > none), falls[e][i] = steep & (up < none);
      }
      neighbours[e] =
          numbers_of([&](Index of) { return EdgeWays::are_neighbours(of, e); }, code) > none;
      for (auto* of : {rises[e], falls[e]}) {
        const Truth<T> both = neighbours[e] & (of[0] | of[1]);
        of[0] = of[0] | both, of[1] = of[1] | both;
      }
    }
    const auto parallel =
        c2 < T(parallel_edges * parallel_edges) * dot(d[0], d[0]) * dot(d[1], d[1]);
    const T together2 = distance_of_shared_ends(x, d, code);
    T opposed[2][2];
    for (Index i = 0; i < 2; ++i)
      for (Index j = 0; j < 2; ++j) opposed[i][j] = dot(normal[0][i], normal[1][j]);
    unsigned open[EdgeWays::count];  // lane by lane, as bits
    for (Index i = 0; i < 2; ++i)
      for (Index j = 0; j < 2; ++j) {
        const T here = opposed[i][j] - T(1e-9), out = along[1][j] - along[0][i];
        const T flat = T(1e-9) * (abs_of(along[1][j]) + abs_of(along[0][i]));
        const T near = T(0.999999 * rules.indentation) * min_of(length[0][i], length[1][j]);
        const auto wrong = parallel | (together2 < near * near) | (apart * out < -room) |
                           !(here < T(-rules.opposing)) |
                           ((out > flat) & (falls[0][i] | rises[1][j])) |
                           ((out < -flat) & (rises[0][i] | falls[1][j]));
        // of two faces at a target edge that which opposes the mother less is not the right one
        const auto left_a = neighbours[0] & (here > opposed[1 - i][j]);
        const auto left_b = neighbours[1] & (here > opposed[i][1 - j]);
        open[EdgeWays::way(false, i, j)] = lane_bits(!(wrong | far[0][i] | left_b));
        open[EdgeWays::way(true, i, j)] = lane_bits(!(wrong | far[1][j] | left_a));
      }
    for_lanes(p, [&](Index lane, Index pair) {
      Index some = 0;
      for (Index way = 0; way < EdgeWays::count; ++way) some |= (open[way] >> lane & 1) << way;
      pairs.open[pair] = Flag(some & of_lane(code, lane));
    });
  }

 private:
  /// Squared distance of the ends that began at one place, or very far: both first ones, or both
  /// last ones, as nearly all are.
  template <class T, class Ids>
  CDEM_HD static T distance_of_shared_ends(const Vec3<T> (&x)[2], const Vec3<T> (&d)[2],
                                           const Ids& code) {
    const T far(1e300), none(0.0);
    T least = far;
    for (const Index ends : {0, 3}) {
      const auto share =
          numbers_of([&](Index of) { return EdgeWays::shared_ends(of) >> ends & 1; }, code) > none;
      const Vec3<T> apart = ends == 0 ? x[1] - x[0] : (x[1] + d[1]) - (x[0] + d[0]);
      least = min_of(least, select(share, dot(apart, apart), far));
    }
    return least;
  }
};

}  // namespace cdem
