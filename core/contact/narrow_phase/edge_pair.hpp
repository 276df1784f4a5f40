// edge_pair.hpp - pairs of edges of the inner list, and in which ways they may touch in a step.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// Side k of the mother and side j of the target. Bit 2 a + b of `shared`: end a of the one and end
/// b of the other began at the same place in the mesh.
struct SidePair {
  Index k, j, shared;
  CDEM_HD Index code() const { return shared << 4 | k << 2 | j; }
  CDEM_HD static SidePair of(Index code) { return {code >> 2 & 3, code & 3, code >> 4}; }
  /// `shared` where the one, or the other, is run through backwards.
  CDEM_HD static Index turned(Index shared, bool one, bool other) {
    if (one) shared = (shared & 3) << 2 | shared >> 2;
    if (other) shared = (shared & 5) << 1 | (shared & 10) >> 1;
    return shared;
  }
  /// `shared` with the two in each other's place.
  CDEM_HD static Index swapped(Index shared) {
    return (shared & 9) | (shared & 2) << 1 | (shared & 4) >> 1;
  }
};

/// Ways to choose the sides of two edges that may touch: of the (at most two) faces at each edge
/// one is the mother's and one the target's.
struct EdgeWays {
  static constexpr Index count = 8;
  /// Is the mother's edge the second one?
  CDEM_HD static bool is_reverse(Index way) { return way & 4; }
  CDEM_HD static Index way(bool reverse, Index i, Index j) { return reverse << 2 | i << 1 | j; }
  /// The ways in which two edges may touch, as bits; which of their ends are shared; which of the
  /// four sides (those of the first edge, then of the second) run against the edges; which of the
  /// edges begin where their first side ends.
  CDEM_HD static Index code_of(Index some, Index shared, Index against, Index turned) {
    return some | shared << count | against << (count + 4) | turned << (count + 8);
  }
  CDEM_HD static bool is_turned(Index code, Index edge) { return code >> (count + 8 + edge) & 1; }
};

/// Pairs of edges of the inner list, see pair_list/prune.hpp.
struct EdgePairs {
  InIndices ends;   // [4][pair]: of one edge, and of the other; if any of them began at the same
                    // place in the mesh, then the first of both
  InIndices sides;  // [4][pair]: 4 * exposed face + side, of the faces at the one, and at the
                    // other; the same twice where there is one
  InIndices code;   // [1][pair]: see EdgeWays
  Flag* open;       // [pair] ways in which they may touch in this step, see FilterEdgePairs

  /// The mother's side and the target's, 4 * exposed face + side.
  struct Sides {
    Index mother, target, shared;
  };
  CDEM_HD Sides sides_of(Index p, Index way) const {
    const Index i = way >> 1 & 1, j = way & 1, bits = code.at(0, One{p});
    const Index against = bits >> (EdgeWays::count + 4);
    const Index a = sides.at(i, One{p}), b = sides.at(2 + j, One{p});
    const Index shared =
        SidePair::turned(bits >> EdgeWays::count & 15, against >> i & 1, against >> (2 + j) & 1);
    if (EdgeWays::is_reverse(way)) return {b, a, SidePair::swapped(shared)};
    return {a, b, shared};
  }
};

/// Sine of the angle between edges that never touch.
inline constexpr Real parallel_edges = 0.02;

/// How far a contact that goes on may cross beyond the ends of the sides, in parts of them.
CDEM_HD inline Real crossing_slack(Real indentation) { return 0.5 * indentation; }

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
  const Index* held;  // [exposed + 1] where the contacts of one step ago begin, by mother face

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
    const T slack(1.000001 * crossing_slack(rules.indentation)), none(0.0);
    Vec3<T> normal[2][2];
    T along[2][2];  // c
    Truth<T> far[2][2];
    for (Index e = 0; e < 2; ++e)
      for (Index i = 0; i < 2; ++i) {
        const auto side = pairs.sides.at(2 * e + i, p);
        const auto face = indices_of([](Index s) { return s / 4; }, side);
        const auto of = geometry.row(face);
        const auto may_go_on =
            numbers_of([&](Index m) { return held[m + 1] - held[m]; }, face) > none;
        normal[e][i] = of.normal;
        along[e][i] = dot(c, of.normal);
        const Vec3<T> start = x[e] + T(rules.indentation) * (of.center - x[e]);
        far[e][i] = crosses_beyond(start, d[e], x[1 - e], d[1 - e], e == 0 ? c : -c, c2, rules,
                                   select(may_go_on, slack, none) + T(1e-9));
      }
    const auto parallel =
        c2 < T(parallel_edges * parallel_edges) * dot(d[0], d[0]) * dot(d[1], d[1]);
    unsigned open[EdgeWays::count];  // lane by lane, as bits
    for (Index i = 0; i < 2; ++i)
      for (Index j = 0; j < 2; ++j) {
        const auto wrong = parallel | (apart * (along[1][j] - along[0][i]) < -room) |
                           !(dot(normal[0][i], normal[1][j]) < T(-rules.opposing));
        open[EdgeWays::way(false, i, j)] = lane_bits(!(wrong | far[0][i]));
        open[EdgeWays::way(true, i, j)] = lane_bits(!(wrong | far[1][j]));
      }
    const auto code = pairs.code.at(0, p);
    for_lanes(p, [&](Index lane, Index pair) {
      Index some = 0;
      for (Index way = 0; way < EdgeWays::count; ++way) some |= (open[way] >> lane & 1) << way;
      pairs.open[pair] = Flag(some & of_lane(code, lane));
    });
  }
};

}  // namespace cdem
