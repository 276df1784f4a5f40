// touching_edges.hpp - in which ways two edges touch. Feng et al. (2014), Eq. 10-12.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"
#include "core/contact/narrow_phase/contact_columns.hpp"
#include "core/contact/narrow_phase/edge_ways.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// Ways in which they touch: lanes as bits, by way.
struct Touching {
  unsigned touches[EdgeWays::count];
  unsigned too_deep[EdgeWays::count];  // they did touch, under load, and penetrate too deep now
};

/// Judges edges that may touch.
///
/// The indented semi-edge decides which edges it crosses; the true edges give gap and force. Of the
/// two faces at a target edge the one that opposes the mother face more is the right face (Eq. 10).
/// Edges between nearly coplanar faces are no edges; the normal must lie in both edges' cones. What
/// the ways of two edges have in common is computed once.
struct TouchingEdges {
  FaceColumns faces;
  FaceGeometry geometry;
  SearchRules rules;
  EdgesBefore held;

  template <class Ids>
  CDEM_HD Touching judge(const TwoEdges<Ids>& pair) const {
    using T = Number<Ids>;
    const Common<T> edges = common(pair);
    AtEdge<T> at[2][2];
    for (Index e = 0; e < 2; ++e) {
      Across<Ids> across[2];
      find_across(pair, e, across);
      for (Index i = 0; i < 2; ++i) at[e][i] = at_edge(pair, edges, across[i], e, i);
    }
    Touching out;
    for (Index i = 0; i < 2; ++i)
      for (Index j = 0; j < 2; ++j) judge(pair, edges, at[0][i], at[1][j], i, j, out);
    return out;
  }

  /// Do two sides (4 * exposed face + side) touch? `shared` tells which of their ends began at the
  /// same place in the mesh, see pair_sides; `before` is the place of their contact one step ago,
  /// or -1.
  CDEM_HD bool touch(Index mother, Index target, Index shared, Index before) const {
    const auto end = [&](Index side, Index which) {
      const ExposedRow& row = geometry.table[side / 4];
      return which ? row.end(side % 4) : row.corner[side % 4];
    };
    return judge(TwoEdges<Index>{
                     .end = {{end(mother, 0), end(mother, 1)}, {end(target, 0), end(target, 1)}},
                     .side = {{mother, mother}, {target, target}},
                     .code = EdgeWays::code_of(1, shared, 0, 0),
                     .before = {before, -1, -1, -1}})
        .touches[0];
  }

 private:
  /// Data shared by all ways of two edges.
  template <class T>
  struct Common {
    Vec3<T> x[2], d[2];  // where they begin, and to where they end  [m]
    Vec3<T> c;           // d[0] x d[1]
    T c2, gap;           // |c|^2; from the second to the first, along c  [m]
    T approach;          // how far they may have come closer before a contact began  [m]
    T together2;         // squared distance of the ends that began at one place, or very far  [m2]
    Truth<T> parallel;
  };
  /// A face at an edge, which it leaves to the left of one of its sides.
  template <class T>
  struct AtEdge {
    Vec3<T> normal, beside;  // of the face; of the exposed one across the side, or of the same
    T length;                // [m]
    Truth<T> sharp;
    Truth<T> goes_on;  // has it a contact with the other edge, as the mother?
    Truth<T> crosses;  // does it cross the other edge, as the mother?
    Truth<T> rises,
        falls;       // do the faces at the edge rise by more than the slack along c, along -c?
    Truth<T> first;  // is it the right face if both oppose the mother alike?
  };

  template <class Ids, class T = Number<Ids>>
  CDEM_HD Common<T> common(const TwoEdges<Ids>& pair) const {
    constexpr Real parallel = parallel_edges;
    Common<T> of;
    for (Index e = 0; e < 2; ++e) {
      of.x[e] = faces.nodes.position(pair.end[e][0]);
      of.d[e] = faces.nodes.position(pair.end[e][1]) - of.x[e];
    }
    const Vec3<T> apart = of.x[1] - of.x[0];
    of.c = cross(of.d[0], of.d[1]);
    of.c2 = dot(of.c, of.c);
    of.parallel = of.c2 < T(parallel * parallel) * dot(of.d[0], of.d[0]) * dot(of.d[1], of.d[1]);
    const T size = sqrt_of(of.c2);
    of.gap = -dot(of.c, apart) / size;
    const T s = dot(cross(apart, of.d[1]), of.c) / of.c2,
            t = dot(cross(apart, of.d[0]), of.c) / of.c2;
    const Vec3<T> rate = velocity_at(pair.end[0], s) - velocity_at(pair.end[1], t);
    of.approach = T(rules.approach_steps * faces.dt) * abs_of(dot(of.c, rate)) / size;
    of.together2 = closest_shared_ends<T>(pair);
    return of;
  }
  template <class Ids, class T>
  CDEM_HD Vec3<T> velocity_at(const Ids (&end)[2], const T& s) const {
    const Vec3<T> first = faces.nodes.velocity(end[0]);
    return first + s * (faces.nodes.velocity(end[1]) - first);
  }
  /// Edges that start from one place in the mesh, and are still there, do not touch each other.
  template <class T, class Ids>
  CDEM_HD T closest_shared_ends(const TwoEdges<Ids>& pair) const {
    const T far(1e300);
    T least = far;
    for (Index a = 0; a < 2; ++a)
      for (Index b = 0; b < 2; ++b) {
        const auto share = EdgeWays::share(pair.code, a, b);
        if (!any_of(share)) continue;
        const Vec3<T> d =
            faces.nodes.position(pair.end[0][a]) - faces.nodes.position(pair.end[1][b]);
        least = min_of(least, select(share, dot(d, d), far));
      }
    return least;
  }

  /// A face at an edge, and its neighbour across the side.
  template <class Ids>
  struct Across {
    Ids face, side, beside;  // the face and its side; the exposed face across, or -1
    FaceRow<Number<Ids>> row;
    Vec3<Number<Ids>> beyond;  // normal across; 0 where there is no face, which does not rise
  };
  /// Where the two faces at an edge are neighbours, each is across the other's side.
  template <class Ids>
  CDEM_HD void find_across(const TwoEdges<Ids>& pair, Index e, Across<Ids> (&of)[2]) const {
    for (Index i = 0; i < 2; ++i) {
      of[i].face = indices_of([](Index side) { return side / 4; }, pair.side[e][i]);
      of[i].side = indices_of([](Index side) { return side % 4; }, pair.side[e][i]);
      of[i].row = geometry.row(of[i].face);
    }
    const bool neighbours = !any_of(!EdgeWays::are_neighbours(pair.code, e));
    const auto beside = [&](Index x, Index side) { return geometry.table[x].beside[side]; };
    for (Index i = 0; i < 2; ++i) {
      of[i].beside = neighbours ? of[1 - i].face : indices_of(beside, of[i].face, of[i].side);
      of[i].beyond = neighbours ? of[1 - i].row.normal
                                : normal_across(faces, geometry, of[i].face, of[i].side);
    }
  }
  template <class Ids, class T>
  CDEM_HD AtEdge<T> at_edge(const TwoEdges<Ids>& pair, const Common<T>& edges,
                            const Across<Ids>& across, Index e, Index i) const {
    const T none(0.0), alpha(rules.indentation), steepest(rules.cone * rules.cone);
    const auto& row = across.row;
    AtEdge<T> at;
    at.normal = row.normal;
    at.length = abs_of(row.length);
    at.sharp = numbers_of([&](Index x, Index side) { return geometry.sharp(x, side); }, across.face,
                          across.side) > none;
    at.beside = select(is_none(across.beside), row.normal, across.beyond);
    at.first = is_none(across.beside) | !is_less(across.beside, across.face);
    at.goes_on = !is_none(pair.before[2 * e + i]);

    const Vec3<T>&d = edges.d[e], &other = edges.d[1 - e], c = e == 0 ? edges.c : -edges.c;
    const Vec3<T> apart = edges.x[1 - e] - (edges.x[e] + alpha * (row.center - edges.x[e]));
    const T s = dot(cross(apart, other), c), t = dot(cross(apart, d), c);
    const T room = select(at.goes_on, T(crossing_slack(rules.indentation)) * edges.c2, none);
    const T shorter(1.0 - rules.indentation);
    at.crosses = !((s < -shorter * room) | (s > shorter * (edges.c2 + room)) | (t < -room) |
                   (t > edges.c2 + room));

    // a face that leaves the side to the left of `along` rises into the normal x along
    const auto against = EdgeWays::runs_against(pair.code, e, i);
    const auto up_of = [&](const Vec3<T>& normal, const auto& backwards) {
      const Vec3<T> into = cross(normal, d);
      const T up = dot(edges.c, into);
      const auto steep = up * up > steepest * dot(into, into) * edges.c2;
      return select(steep, select(backwards, -up, up), none);
    };
    const T here = up_of(row.normal, against), there = up_of(across.beyond, !against);
    at.rises = (here > none) | (there > none);
    at.falls = (here < none) | (there < none);
    return at;
  }

  /// Judge the two ways with a face of the first edge and one of the second.
  template <class Ids, class T>
  CDEM_HD void judge(const TwoEdges<Ids>& pair, const Common<T>& edges, const AtEdge<T>& a,
                     const AtEdge<T>& b, Index i, Index j, Touching& out) const {
    const T none(0.0), opposed = dot(a.normal, b.normal);
    // the normal of the contact, on the side of b: c or -c
    const Truth<T> turned = dot(edges.c, b.normal - a.normal) < none, straight = !turned;
    const T gap = select(turned, -edges.gap, edges.gap), length = min_of(a.length, b.length);
    const T together = T(rules.indentation) * length;
    const Truth<T> may = a.sharp & b.sharp & (opposed < T(-rules.opposing)) &
                         !(edges.parallel | (edges.together2 < together * together)) &
                         !((turned & (a.rises | b.falls)) | (straight & (a.falls | b.rises)));
    for (Index order = 0; order < 2; ++order) {
      const bool reverse = order == 1;
      const AtEdge<T>&mother = reverse ? b : a, &target = reverse ? a : b;
      const Index way = EdgeWays::way(reverse, i, j);
      const Ids& before = pair.before[EdgeWays::mother(way)];
      const T there = dot(mother.normal, target.beside);
      const Truth<T> touch = may & ((opposed < there) | (target.first & !(opposed > there))) &
                             mother.crosses & !(gap > highest_gap(before));
      const T limit =
          select(mother.goes_on, T(rules.depth) * length, T(rules.entry) * length + edges.approach);
      const Truth<T> deep = touch & (gap < -limit);
      out.touches[way] = lane_bits(touch & !deep);
      out.too_deep[way] = any_of(deep) ? lane_bits(deep & is_loaded(before)) : 0;
    }
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
  template <class Ids, class T = Number<Ids>>
  CDEM_HD Truth<T> is_loaded(const Ids& before) const {
    const auto force = [&](Index b) {
      return b < 0 ? 0.0 : ContactState::at(held.state, b).force_n;
    };
    return numbers_of(force, before) > T(0.0);
  }
};

}  // namespace cdem
