// moving_edge.hpp - edges of patches, how they may move, and two of them as seen from each other.
#pragma once

#include "core/contact/broad_phase/separating_planes.hpp"
#include "core/contact/narrow_phase/edge_ways.hpp"

namespace cdem {

/// An edge, and how its ends may move until the next rebuild.
struct MovingEdge {
  const ExposedFace* face;  // the first of the faces at the edge
  const ExposedSide* side;  // of it
  Index node[2], bonded_node[2], place[2];
  Vec3<Real> end[2], path[2];              // [m]
  Vec3<Real> along;                        // from the first end to the second, of unit length
  Real length, skin[2], widest, rotation;  // [m], [m], the larger skin [m], [rad]
  Indented indented;

  CDEM_HD MovingEdge(const PairContext& f, const Patch& a, const Patch::Edge& edge)
      : face(f.exposed + a.face[edge.face[0]]),
        side(f.sides + 4 * std::size_t(a.face[edge.face[0]]) + edge.side[0]),
        indented(edge.indented) {
    for (Index i = 0; i < 2; ++i) {
      node[i] = a.vertex[edge.vertex[i]];
      bonded_node[i] = f.faces.bonded_node[node[i]];
      place[i] = f.faces.node_place[node[i]];
      const PredictedNode predicted = f.predicted.at(node[i]);
      end[i] = predicted.position;
      path[i] = f.lookahead_time * predicted.velocity;
      skin[i] = predicted.skin;
    }
    length = side->length;
    along = 1 / length * side->along;
    widest = max_of(skin[1], skin[0]);
    rotation = (norm(path[1] - path[0]) + 2 * widest) / length;
  }
  CDEM_HD Vec3<Real> path_at(Real at) const { return path[0] + at / length * (path[1] - path[0]); }
};

/// The same of the edges of all patches.
struct MakeMovingEdges {
  PairContext f;
  MovingEdge* edges;

  CDEM_HD void operator()(One p) const {
    const Patch& patch = f.patches[p.i];
    for (Index e = 0; e < patch.edge_count; ++e)
      edges[patch.edge_first + e] = MovingEdge(f, patch, patch.edge[e]);
  }
};

/// A number from `low` to `high` that is nearest to x.
CDEM_HD inline Real within(Real x, Real low, Real high) { return max_of(low, min_of(x, high)); }

/// Ends of two edges, and which of them began at the same place in the mesh: bit 2 a + b of
/// `shared` for end a of the one and end b of the other.
struct SharedEnds {
  Index shared = 0;
  bool bonded = false;  // intact bonds hold ends together
  Real parted = 1e300;  // how far the closest of the shared ends may part before the next rebuild

  CDEM_HD SharedEnds(const MovingEdge& p, const MovingEdge& q) {
    for (Index i = 0; i < 4; ++i) {
      const Index a = i >> 1, b = i & 1;
      bonded = bonded || p.bonded_node[a] == q.bonded_node[b];
      if (p.place[a] != q.place[b]) continue;
      shared |= 1 << i;
      parted = min_of(
          norm(p.end[a] - q.end[b]) + norm(p.path[a] - q.path[b]) + p.skin[a] + q.skin[b], parted);
    }
  }
};

/// Square of the distance of two edges  [m2].
CDEM_HD inline Real distance2(const MovingEdge& p, const MovingEdge& q) {
  const Vec3<Real> apart = p.end[0] - q.end[0];
  const Real cosine = dot(p.along, q.along), det = 1 - cosine * cosine;
  const Real on_p = dot(p.along, apart), on_q = dot(q.along, apart);
  Real s = det > 1e-12 ? within((cosine * on_q - on_p) / det, 0.0, p.length) : 0.0;
  const Real t = within(cosine * s + on_q, 0.0, q.length);
  s = within(cosine * t - on_p, 0.0, p.length);
  const Vec3<Real> nearest = apart + s * p.along - t * q.along;
  return dot(nearest, nearest);
}

/// Are the lines of two edges farther apart than `room` [m]?
CDEM_HD inline bool lines_are_far(const MovingEdge& p, const MovingEdge& q, Real room) {
  const Vec3<Real> normal = cross(p.along, q.along);
  const Real off = dot(normal, p.end[0] - q.end[0]);
  return off * off > room * room * dot(normal, normal);
}

/// How far the predicted paths of two points of the one and of the other part while an inner list
/// holds  [m].
CDEM_HD inline Real ways_part_soon(const MovingEdge& p, const MovingEdge& q) {
  Real most = 0;
  for (Index i = 0; i < 4; ++i) most = max_of(norm(p.path[i >> 1] - q.path[i & 1]), most);
  return inner_horizon * most;
}

/// Two edges seen along their common perpendicular.
struct TwoLines {
  const MovingEdge &p, &q;
  Vec3<Real> n;
  Real gap;  // from the line of q to the line of p along n  [m]
  Real rotations,
      sine;  // by which both may rotate  [rad]; of the angle between them then, at least

  /// `cross` is that of the directions, of length `size`.
  CDEM_HD TwoLines(const MovingEdge& one, const MovingEdge& other, const Vec3<Real>& cross,
                   Real size)
      : p(one),
        q(other),
        n(1 / size * cross),
        gap(dot(n, p.end[0] - q.end[0])),
        rotations(p.rotation + q.rotation),
        sine(size - rotations) {}

  /// On which sides of each other the two may touch before the next rebuild, as bits: 1 where the
  /// contact normal is n, 2 where it is -n. The tests of ResolveTargetEdges with room for the
  /// motion.
  ///
  /// In contact the gap between the points that cross then is not positive along the normal n' of
  /// that time. They lie on n', so the gap of the same points along n was not positive either, but
  /// for how they move along n. (What little beyond its ends an edge may be crossed, see pass_by,
  /// rotates with it.)
  CDEM_HD Index sides(const SearchRules& rules) const {
    const ExposedSide &on_p = *p.side, &on_q = *q.side;
    const Real swing = rotations / sine;  // of the normal
    const Real room = swing * max_of(p.indented.shift, q.indented.shift) + rules.lifted;
    const auto beyond = [&](Real sine_of_cone, const MovingEdge& of, Real rotation_face) {
      return sine_of_cone < -(rules.cone + swing + of.rotation + rotation_face);
    };
    Index found = 0;
    for (Index side = 1; side <= 2; ++side) {
      const Real sign = side == 1 ? 1 : -1;
      if (sign * gap + GapChange(*p.face, *q.face, sign * n).least > room ||
          beyond(sign * dot(n, on_p.fall), p, on_p.rotation_face) ||
          beyond(-sign * dot(n, on_q.fall), q, on_q.rotation_face) ||
          (on_p.across >= 0 && beyond(sign * dot(n, on_p.fall_across), p, on_p.rotation_across)) ||
          (on_q.across >= 0 && beyond(-sign * dot(n, on_q.fall_across), q, on_q.rotation_across)))
        continue;
      found |= side;
    }
    return found;
  }

  /// Does the crossing of the lines stay off the ends of the edges until the next rebuild, so that
  /// MarkNearEdges finds them far in every step?
  ///
  /// The line of an edge d (of unit length) crosses the other one between its ends x0 and x1 if
  /// these lie on different sides of it: (y - x) . (d x n) is the distance of an end from the line
  /// through y. It changes by no more than the end moves as seen from its foot on the line, and by
  /// its distance from the foot times the rotation of d and n.
  CDEM_HD bool pass_by() const {
    const Indented edges = p.indented.and_of(q.indented);
    const Real cosine = min_of(1.0, abs_of(dot(p.along, q.along)) + rotations);
    const Real inset = sine * edges.inset - cosine * edges.shift, beside = -edges.shift;
    const auto crosses = [&](Real on_p, Real on_q) {
      return (on_p > inset && on_q > beside) || (on_q > inset && on_p > beside);
    };
    const Ends of_p(p, q, n), of_q(q, p, n);
    if (crosses(of_p.inside(), of_q.inside())) return false;
    const Real round_off = 1e-6 * min_of(p.length, q.length), swing = rotations / sine;
    return !crosses(of_p.may_be_inside(swing) + round_off, of_q.may_be_inside(swing) + round_off);
  }

 private:
  /// The ends of an edge as seen from the line of the other.
  struct Ends {
    const MovingEdge &on, &line;
    Vec3<Real> arm[2];
    Real off[2];  // from the line, > 0 if it crosses the edge on this side of the end  [m]

    CDEM_HD Ends(const MovingEdge& edge, const MovingEdge& other, const Vec3<Real>& n)
        : on(edge), line(other), arm{other.end[0] - edge.end[0], other.end[0] - edge.end[1]} {
      const Vec3<Real> across = cross(line.along, n);
      const Real sign = dot(on.along, across) < 0 ? -1 : 1;
      off[0] = sign * dot(arm[0], across);
      off[1] = -sign * dot(arm[1], across);
    }
    /// How far from the ends of the edge the line crosses it, times the sine of the angle.
    CDEM_HD Real inside() const { return min_of(off[0], off[1]); }
    /// The same until the next rebuild, at most.
    CDEM_HD Real may_be_inside(Real swing) const {
      Real least = 1e300;
      for (Index i = 0; i < 2; ++i) {
        const Real foot = -dot(arm[i], line.along), nearest = within(foot, 0.0, line.length);
        const Real motion = norm(on.path[i] - line.path_at(nearest)) + on.skin[i] + line.widest;
        const Real change = motion + line.rotation * abs_of(foot - nearest) +
                            (line.rotation + swing) * norm(arm[i] + foot * line.along);
        least = min_of(off[i] + change, least);
      }
      return least;
    }
  };
};

}  // namespace cdem
