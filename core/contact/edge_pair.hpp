// edge_pair.hpp - pairs of edges that may touch: which are near in a step, and in which ways.
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

/// Pairs of edges that may touch before the next refresh. Of the (at most two) faces at each edge
/// one is the mother's and one the target's: eight ways to choose the sides.
struct EdgePairs {
  InIndices ends;      // [4][pair]: of one edge, and of the other; if any of them began at the same
                       // place in the mesh, then the first of both
  InIndices edges;     // [2][pair]: places in `sides`
  const Index* code;   // [pair]: see code_of
  const Index* sides;  // [edge][2]: 4 * exposed face + side, or -1
  Flag* near;          // [pair] 0: they cannot begin to touch in this step; held: they did before
  Flag* open;          // [pair] of those that are near: ways in which they may, see SiftTargetEdges

  static constexpr Index ways = 8;
  static constexpr Flag held = 2;
  /// Is the mother's edge the second one?
  CDEM_HD static bool is_reverse(Index way) { return way & 4; }
  CDEM_HD static Index way(bool reverse, Index i, Index j) { return reverse << 2 | i << 1 | j; }
  /// The ways in which two edges may touch, as bits; which of their ends are shared; which of the
  /// four sides (those of the first edge, then of the second) run against the edges.
  CDEM_HD static Index code_of(Index some, Index shared, Index against) {
    return some | shared << ways | against << (ways + 4);
  }

  /// Side i of the first edge, or of the second one, as it is in `sides`; the other one if there is
  /// only one.
  CDEM_HD Index side(Index p, bool second, Index i) const {
    const Index* of = sides + 2 * edges.at(second, One{p});
    return of[i] >= 0 ? of[i] : of[0];
  }
  /// The mother's side and the target's, 4 * exposed face + side.
  struct Sides {
    Index mother, target, shared;
  };
  CDEM_HD Sides sides_of(Index p, Index way) const {
    const Index i = way >> 1 & 1, j = way & 1, against = code[p] >> (ways + 4);
    const Index a = sides[2 * edges.at(0, One{p}) + i], b = sides[2 * edges.at(1, One{p}) + j];
    const Index shared =
        SidePair::turned(code[p] >> ways & 15, against >> i & 1, against >> (2 + j) & 1);
    if (is_reverse(way)) return {b, a, SidePair::swapped(shared)};
    return {a, b, shared};
  }
};

/// Mark the pairs of edges that may begin to touch in this step. One test stands for the sides of
/// all faces at both edges, in either direction, and has room for what distinguishes them: their
/// indentation and the rate of approach. So what is found in contact does not depend on it.
struct MarkNearEdges {
  InMotion nodes;
  InIndices ends;   // see EdgePairs
  InBounds room;    // [5][pair]: depth at which a contact may begin; how far the indentation moves
                    // an edge aside, at most  [m]; side on which one edge must be of the other,
                    // along the cross product: 1, -1, 0: either; what it takes from the ends of an
                    // edge, at least; distance of the first ends at which edges are together  [m]
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
    const T deep2 = gap * gap, depth2 = depth * depth * c2, together = room.at(4, p);
    const auto far = (c2 < T(parallel * parallel) * a2 * b2) | (deep2 > depth2) |
                     ((room.at(2, p) * gap < T(0.0)) & (deep2 > T(round_off) * depth2)) |
                     (dot(apart, apart) < together * together);
    if (!any_of(!far)) return set_flags(near, p, !far);
    // where the lines cross, from the starts of the edges [m]. An indented edge lies beside the
    // true one by `shift` at most, so that the crossing with the target moves by shift / sin of the
    // angle between the two on the target, and by shift * cot on the edge itself.
    const T long_a = sqrt_of(a2), long_b = sqrt_of(b2), per_c = T(1.0) / sqrt_of(c2);
    const T on_a = dot(cross(apart, along_b), c) * per_c * per_c * long_a;
    const T on_b = dot(cross(apart, along_a), c) * per_c * per_c * long_b;
    const T inset = room.at(3, p) - shift * abs_of(dot(along_a, along_b)) * per_c;
    const T beside = -shift * long_a * long_b * per_c;
    set_flags(near, p,
              !far & ((within(on_a, inset, long_a) & within(on_b, beside, long_b)) |
                      (within(on_b, inset, long_b) & within(on_a, beside, long_a))));
  }

 private:
  /// Not less than the length of a vector.
  template <class T>
  CDEM_HD static T size(const Vec3<T>& v) {
    return abs_of(v.x) + abs_of(v.y) + abs_of(v.z);
  }
  /// Does a place on an edge lie at least `from_ends` from both ends?
  template <class T>
  CDEM_HD static auto within(const T& place, const T& from_ends, const T& length) {
    return !((place < from_ends) | (place > length - from_ends));
  }
};

/// Those that were in contact one step ago must be looked at all the same: whatever faces the pair
/// is listed for, as another face at the target edge may be the right one now.
struct MarkHeldEdges {
  const Index* exposed_face;
  const Index* face_edges;  // see FaceColumns
  const Index* contact;     // rows of EdgeContact, one step ago
  const Index* first;       // [edge + 1]
  const Index* listed;      // rows of 2, by edge: pair that it is of, the other edge
  Flag* near;

  CDEM_HD void operator()(One c) const {
    const EdgeContact held = EdgeContact::at(contact, c.i);
    const Index edge = face_edges[4 * exposed_face[held.mother / 4] + held.mother % 4];
    for (Index i = first[edge]; i < first[edge + 1]; ++i)
      if (listed[2 * i + 1] == held.edge) set(near[listed[2 * i]], EdgePairs::held);
  }
};

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

/// Sift the ways in which edges that are near each other may touch: most do not cross where the
/// mother's is indented, or are on the wrong side of each other. It is seen for all ways at once,
/// from the common perpendicular, without a root or a division. Those that may are left to
/// TouchTargetEdges; that its tests are the same but for some room, nothing found depends on it.
struct SiftTargetEdges {
  InMotion nodes;
  FaceGeometry geometry;
  EdgePairs pairs;
  SearchRules rules;

  CDEM_HD Range items(Index p) const { return {p, p + (pairs.near[p] ? 1 : 0)}; }
  CDEM_HD bool picks(Index, Index) const { return true; }
  template <class I>
  CDEM_HD void operator()(const I& item) const {
    using T = Number<I>;
    const auto end = [&](Index k) {
      return nodes.position(indices_of([&](Index p) { return pairs.ends.at(k, One{p}); }, item.id));
    };
    const Vec3<T> x[2] = {end(0), end(2)}, d[2] = {end(1) - x[0], end(3) - x[1]};
    const Vec3<T> c = cross(d[0], d[1]);
    const T c2 = dot(c, c), apart = dot(x[1] - x[0], c), zero(0.0);
    // of a gap, times |c| twice: which side it is on is left to TouchTargetEdges then
    const T round_off = T(1e-12) * c2 * (abs_of(d[0].x) + abs_of(d[0].y) + abs_of(d[0].z));
    const auto goes_on =
        numbers_of([&](Index p) { return pairs.near[p] == EdgePairs::held; }, item.id) > zero;
    const T slack = select(goes_on, T(1.000001 * crossing_slack(rules.indentation)), zero);
    Vec3<T> normal[2][2];
    T along[2][2];  // c
    Truth<T> far[2][2];
    for (Index e = 0; e < 2; ++e)
      for (Index i = 0; i < 2; ++i) {
        const auto face = indices_of([&](Index p) { return pairs.side(p, e, i) / 4; }, item.id);
        const auto of = geometry.row(face);
        normal[e][i] = of.normal;
        along[e][i] = dot(c, of.normal);
        const Vec3<T> start = x[e] + T(rules.indentation) * (of.center - x[e]);
        far[e][i] = crosses_beyond(start, d[e], x[1 - e], d[1 - e], e == 0 ? c : -c, c2, rules,
                                   slack + T(1e-9));
      }
    const auto parallel = c2 < T(MarkNearEdges::parallel * MarkNearEdges::parallel) *
                                   dot(d[0], d[0]) * dot(d[1], d[1]);
    unsigned open[EdgePairs::ways];  // lane by lane, as bits
    for (Index i = 0; i < 2; ++i)
      for (Index j = 0; j < 2; ++j) {
        const auto wrong = parallel | (apart * (along[1][j] - along[0][i]) < -round_off) |
                           !(dot(normal[0][i], normal[1][j]) < T(-rules.opposing));
        open[EdgePairs::way(false, i, j)] = lane_bits(!(wrong | far[0][i]));
        open[EdgePairs::way(true, i, j)] = lane_bits(!(wrong | far[1][j]));
      }
    for_lanes(item, [&](Index lane, Index, Index p) {
      Index some = 0;
      for (Index way = 0; way < EdgePairs::ways; ++way) some |= (open[way] >> lane & 1) << way;
      pairs.open[p] = Flag(some & pairs.code[p]);
    });
  }
};

}  // namespace cdem
