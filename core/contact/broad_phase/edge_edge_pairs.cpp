// edge_edge_pairs.cpp - see edge_edge_pairs.hpp.
#include "core/contact/broad_phase/edge_edge_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/contact/broad_phase/separating_planes.hpp"
#include "core/contact/narrow_phase/edge_pair.hpp"
#include "core/contact/narrow_phase/side_pairs.hpp"

namespace cdem {

namespace {

/// Is face y the right face of its side for a mother face x, or may it become so?
bool may_be_right(const PairContext& f, const ExposedFace& x, const ExposedFace& y,
                  const ExposedSide& q) {
  const Real rotations = 2 * (x.rotation + y.rotation) + q.rotation_across;
  return q.across < 0 ||
         !(dot(x.normal, f.exposed[q.across].normal) < dot(x.normal, y.normal) - rotations);
}

/// An edge, and how its ends may move until the next rebuild.
struct MovingEdge {
  const ExposedFace* face;  // the first of the faces at the edge
  const ExposedSide* side;  // of it
  Index node[2], bonded_node[2], place[2];
  Vec3<Real> end[2], path[2];              // [m]
  Vec3<Real> along;                        // from the first end to the second, of unit length
  Real length, skin[2], widest, rotation;  // [m], [m], the larger skin [m], [rad]
  Indented indented;

  MovingEdge(const PairContext& f, const Patch& a, const Patch::Edge& edge)
      : face(&f.exposed[a.face[edge.face[0]]]),
        side(&f.sides[4 * std::size_t(a.face[edge.face[0]]) + edge.side[0]]),
        indented(edge.indented) {
    for (const int i : {0, 1}) {
      node[i] = a.vertex[edge.vertex[i]];
      bonded_node[i] = f.faces.bonded_node[node[i]];
      place[i] = f.faces.node_place[node[i]];
      const PredictedNode predicted = f.predicted.at(node[i]);
      end[i] = predicted.position;
      path[i] = f.s.search.outer.lookahead_time * predicted.velocity;
      skin[i] = predicted.skin;
    }
    length = side->length;
    along = 1 / length * side->along;
    widest = std::max(skin[0], skin[1]);
    rotation = (norm(path[1] - path[0]) + 2 * widest) / length;
  }
  Vec3<Real> path_at(Real at) const { return path[0] + at / length * (path[1] - path[0]); }
};

/// Edges of a patch, each computed once, at first use.
class MovingEdges {
  const PairContext& f;
  const Patch& patch;
  std::optional<MovingEdge> edge[12];

 public:
  MovingEdges(const PairContext& context, const Patch& of) : f(context), patch(of) {}
  const MovingEdge& operator[](Index e) {
    if (!edge[e]) edge[e].emplace(f, patch, patch.edge[e]);
    return *edge[e];
  }
};

/// Ends of two edges, and which of them began at the same place in the mesh: bit 2 a + b of
/// `shared` for end a of the one and end b of the other.
struct SharedEnds {
  Index shared = 0;
  bool bonded = false;  // intact bonds hold ends together
  Real parted = 1e300;  // how far the closest of the shared ends may part before the next rebuild

  SharedEnds(const MovingEdge& p, const MovingEdge& q) {
    for (Index i = 0; i < 4; ++i) {
      const Index a = i >> 1, b = i & 1;
      bonded = bonded || p.bonded_node[a] == q.bonded_node[b];
      if (p.place[a] != q.place[b]) continue;
      shared |= 1 << i;
      parted = std::min(
          parted, norm(p.end[a] - q.end[b]) + norm(p.path[a] - q.path[b]) + p.skin[a] + q.skin[b]);
    }
  }
};

/// Square of the distance of two edges  [m2].
Real distance2(const MovingEdge& p, const MovingEdge& q) {
  const Vec3<Real> apart = p.end[0] - q.end[0];
  const Real cosine = dot(p.along, q.along), det = 1 - cosine * cosine;
  const Real on_p = dot(p.along, apart), on_q = dot(q.along, apart);
  Real s = det > 1e-12 ? std::clamp((cosine * on_q - on_p) / det, 0.0, p.length) : 0.0;
  const Real t = std::clamp(cosine * s + on_q, 0.0, q.length);
  s = std::clamp(cosine * t - on_p, 0.0, p.length);
  const Vec3<Real> nearest = apart + s * p.along - t * q.along;
  return dot(nearest, nearest);
}

/// Two edges seen along their common perpendicular.
struct TwoLines {
  const MovingEdge &p, &q;
  Vec3<Real> n;
  Real gap;  // from the line of q to the line of p along n  [m]
  Real rotations,
      sine;  // by which both may rotate  [rad]; of the angle between them then, at least

  /// `cross` is that of the directions, of length `size`.
  TwoLines(const MovingEdge& one, const MovingEdge& other, const Vec3<Real>& cross, Real size)
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
  int sides(const SearchRules& rules) const {
    const ExposedFace &x = *p.face, &y = *q.face;
    const ExposedSide &on_p = *p.side, &on_q = *q.side;
    const Real swing = rotations / sine;  // of the normal
    const Real room = swing * std::max(p.indented.shift, q.indented.shift) + rules.lifted;
    const auto beyond = [&](Real sine_of_cone, const MovingEdge& of, Real rotation_face) {
      return sine_of_cone < -(rules.cone + swing + of.rotation + rotation_face);
    };
    int found = 0;
    for (const int side : {1, 2}) {
      const Real sign = side == 1 ? 1 : -1;
      if (sign * gap + GapChange(x, y, sign * n).least > room ||
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
  bool pass_by() const {
    const Indented edges = p.indented.and_of(q.indented);
    const Real cosine = std::min(1.0, std::abs(dot(p.along, q.along)) + rotations);
    const Real inset = sine * edges.inset - cosine * edges.shift, beside = -edges.shift;
    const auto crosses = [&](Real on_p, Real on_q) {
      return (on_p > inset && on_q > beside) || (on_q > inset && on_p > beside);
    };
    const Ends of_p(p, q, n), of_q(q, p, n);
    if (crosses(of_p.inside(), of_q.inside())) return false;
    const Real round_off = 1e-6 * std::min(p.length, q.length), swing = rotations / sine;
    return !crosses(of_p.may_be_inside(swing) + round_off, of_q.may_be_inside(swing) + round_off);
  }

 private:
  /// The ends of an edge as seen from the line of the other.
  struct Ends {
    const MovingEdge &on, &line;
    Vec3<Real> arm[2];
    Real off[2];  // from the line, > 0 if it crosses the edge on this side of the end  [m]

    Ends(const MovingEdge& edge, const MovingEdge& other, const Vec3<Real>& n)
        : on(edge), line(other), arm{other.end[0] - edge.end[0], other.end[0] - edge.end[1]} {
      const Vec3<Real> across = cross(line.along, n);
      const Real sign = dot(on.along, across) < 0 ? -1 : 1;
      off[0] = sign * dot(arm[0], across);
      off[1] = -sign * dot(arm[1], across);
    }
    /// How far from the ends of the edge the line crosses it, times the sine of the angle.
    Real inside() const { return std::min(off[0], off[1]); }
    /// The same until the next rebuild, at most.
    Real may_be_inside(Real swing) const {
      Real least = 1e300;
      for (const int i : {0, 1}) {
        const Real foot = -dot(arm[i], line.along), nearest = std::clamp(foot, 0.0, line.length);
        const Real motion = norm(on.path[i] - line.path_at(nearest)) + on.skin[i] + line.widest;
        const Real change = motion + line.rotation * std::abs(foot - nearest) +
                            (line.rotation + swing) * norm(arm[i] + foot * line.along);
        least = std::min(least, off[i] + change);
      }
      return least;
    }
  };
};

/// How far the predicted paths of two points of the one and of the other part while an inner list
/// holds  [m].
Real ways_part_soon(const MovingEdge& p, const MovingEdge& q) {
  Real most = 0;
  for (Index i = 0; i < 4; ++i) most = std::max(most, norm(p.path[i >> 1] - q.path[i & 1]));
  return inner_horizon * most;
}

/// In which ways two edges may touch, see EdgeWays, as bits.
Index ways_to_touch(const PairContext& f, const Patch& a, const Patch::Edge& p, const Patch& b,
                    const Patch::Edge& q, const FacePairMask& pairs, const SharedEnds& ends,
                    ListedFacePairs& listed) {
  Index ways = 0;
  for (Index i = 0; i < p.faces; ++i)
    for (Index j = 0; j < q.faces; ++j) {
      if (!(pairs.row[p.face[i]] >> q.face[j] & 1)) continue;
      const Index face_p = a.face[p.face[i]], face_q = b.face[q.face[j]];
      const ExposedFace &x = f.exposed[face_p], &y = f.exposed[face_q];
      // ends that stay together are no edges on each other, see ResolveTargetEdges
      if (ends.parted < f.m.rules.indentation * std::min(x.length, y.length)) continue;
      if (may_be_right(f, x, y, f.sides[4 * std::size_t(face_q) + q.side[j]])) {
        ways |= 1 << EdgeWays::way(false, i, j);
        listed.add(false, p.face[i], q.face[j]);
      }
      if (may_be_right(f, y, x, f.sides[4 * std::size_t(face_p) + p.side[i]])) {
        ways |= 1 << EdgeWays::way(true, i, j);
        listed.add(true, q.face[j], p.face[i]);
      }
    }
  return ways;
}

/// Was an edge in contact with another one a step ago?
bool in_contact(const PairContext& f, const Patch& a, const Patch::Edge& p, Index edge) {
  for (Index i = 0; i < p.faces; ++i) {
    const Index x = a.face[p.face[i]];
    for (Index c = f.edge_first[x]; c < f.edge_first[x + 1]; ++c) {
      const EdgeContact contact = EdgeContact::at(f.edge_contact.data(), c);
      if (contact.mother == 4 * x + p.side[i] && contact.edge == edge) return true;
    }
  }
  return false;
}

/// Two edges as MarkNearEdges sees them, on sides `on` of each other: those of their ends first
/// that began at the same place, if any. `ways` are those in which they may touch.
PairBuffer::EdgePair near_edges(const PairContext& f, const Patch& a, Index e, const MovingEdge& p,
                                const Patch& b, Index g, const MovingEdge& q,
                                const SharedEnds& ends, int on, Index ways) {
  const SearchRules& rules = f.m.rules;
  const Indented edges = p.indented.and_of(q.indented);
  Index first = 0;
  while (ends.shared && !(ends.shared >> first & 1)) ++first;
  const Index first_p = first >> 1, first_q = first & 1;
  const auto against = [&](const Patch& of, const Patch::Edge& edge, Index start) {
    Index sides = 0;
    for (Index i = 0; i < edge.faces; ++i)
      sides |= (f.faces.vertex(f.exposed[of.face[edge.face[i]]].face, edge.side[i]) != start) << i;
    return sides;
  };
  const Index sides =
      against(a, a.edge[e], p.node[first_p]) | against(b, b.edge[g], q.node[first_q]) << 2;
  // seen along the cross product of the two as their ends are listed here
  const Real sign = on == 3 ? 0 : ((on == 1) != (first_p != first_q) ? 1 : -1);
  return {{a.edge_first + e, b.edge_first + g},
          {float(1.000001 * rules.entry * std::min(a.length, b.length)), float(edges.shift),
           float(sign), float(edges.inset),
           float(ends.shared ? 0.999999 * rules.indentation * edges.length : 0),
           float(ways_part_soon(p, q) + 1e-6 * edges.length)},
          EdgeWays::code_of(ways, EdgeWays::turned(ends.shared, first_p, first_q), sides,
                            first_p | first_q << 1)};
}

/// Are the lines of two edges farther apart than `room` [m]?
bool lines_are_far(const MovingEdge& p, const MovingEdge& q, Real room) {
  const Vec3<Real> normal = cross(p.along, q.along);
  const Real off = dot(normal, p.end[0] - q.end[0]);
  return off * off > room * room * dot(normal, normal);
}

/// Do shared ends stay so close that the edges are no edges on each other, see ResolveTargetEdges?
bool stay_together(const SearchRules& rules, const MovingEdge& p, const MovingEdge& q,
                   const SharedEnds& ends) {
  return ends.parted < rules.indentation * std::min(p.indented.length, q.indented.length);
}

/// On which sides of each other two edges may touch before the next rebuild, see TwoLines::sides:
/// both where they may become parallel; 0 where they cannot touch. Edges in contact go on.
int touching_sides(const PairContext& f, const Patch& a, const Patch::Edge& of_a,
                   const MovingEdge& p, const Patch& b, const Patch::Edge& of_b,
                   const MovingEdge& q, Real room) {
  const Vec3<Real> normal = cross(p.along, q.along);
  const Real sine = norm(normal), rotations = p.rotation + q.rotation;
  if (sine + rotations < parallel_edges) return 0;
  if (!(sine > rotations)) return distance2(p, q) > room * room ? 0 : 3;
  const TwoLines lines(p, q, normal, sine);
  const int sides = lines.sides(f.m.rules);
  if (sides && lines.pass_by() && !in_contact(f, a, of_a, of_b.id) &&
      !in_contact(f, b, of_b, of_a.id))
    return 0;
  return sides;
}

}  // namespace

void list_edges(const PairContext& f, const Patch& a, const Patch& b, const FacePairMask& pairs,
                const SeparatedParts& separated, ListedFacePairs& listed, PairBuffer& found) {
  const Real room =
      farthest_crossing(f.m.rules, a, b) + last_step * norm(b.displacement - a.displacement);
  MovingEdges of_a(f, a), of_b(f, b);
  for (Index e = 0; e < a.edge_count; ++e) {
    const int opposite = pairs.of(a.edge[e]);
    if (separated.edge[0][e] || !opposite) continue;
    const MovingEdge& p = of_a[e];
    if (!p.side->sharp) continue;
    for (Index g = 0; g < b.edge_count; ++g) {
      if (separated.edge[1][g] || !(opposite & FacePairMask::at(b.edge[g]))) continue;
      const MovingEdge& q = of_b[g];
      if (!q.side->sharp || lines_are_far(p, q, room)) continue;
      const SharedEnds ends(p, q);
      if (ends.bonded || stay_together(f.m.rules, p, q, ends)) continue;
      const int sides = touching_sides(f, a, a.edge[e], p, b, b.edge[g], q, room);
      if (!sides) continue;
      const Index ways = ways_to_touch(f, a, a.edge[e], b, b.edge[g], pairs, ends, listed);
      if (ways) found.edges.push_back(near_edges(f, a, e, p, b, g, q, ends, sides, ways));
    }
  }
}

}  // namespace cdem
