// proximity.cpp - pairs of patches, and what of them may touch before the lists are renewed.
#include "core/proximity.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/columns.hpp"
#include "core/contact/boxes.hpp"

namespace cdem {

namespace {

/// What the search for one pair of patches needs.
struct Finder {
  const Model& m;
  const State& s;
  const FaceColumns faces;
  const Unset<ExposedFace>& exposed;
  const Unset<ExposedSide>& sides;
  const Bonded& bonded;
};

constexpr Real last_step = 1.05;  // the last step counts 1.5 times, see SearchRules::entry

/// How far a vertex of one face may move as seen from the other  [m].
Real motion_between(const ExposedFace& x, const ExposedFace& y) {
  return norm(x.drift - y.drift) + x.stir + y.stir;
}

/// How far two watched nodes may move apart until the next refresh  [m].
Real may_part(const State& s, Index a, Index b) {
  const WatchedNode x = WatchedNode::of(s, a), y = WatchedNode::of(s, b);
  return s.search.horizon * norm(x.velocity - y.velocity) + x.skin + y.skin;
}

/// How much the gap between anything of x and of y along a normal of y (or of both) may change, at
/// least and at most  [m].
struct GapChange {
  Real least, most;
  GapChange(const ExposedFace& x, const ExposedFace& y, const Vec3<Real>& n) {
    const Real approach = dot(n, x.drift - y.drift), stir = x.stir + y.stir;
    least = std::min(approach, 0.0) - stir;
    most = std::max(approach, 0.0) + stir;
  }
};

/// Farthest that anything of one patch may be from the other when lists are made, if it may be in
/// contact before they are renewed  [m]; but for the drifts, which have a direction.
Real farthest_contact(const SearchRules& rules, const Patch& a, const Patch& b) {
  return last_step * (a.stir + b.stir) + a.deepest + b.deepest + rules.lifted +
         (rules.entry + 2 * rules.tolerance) * std::min(a.length, b.length) +
         2 * rules.indentation * std::max(a.reach, b.reach);
}

/// Does a plane along a face of either patch hold the two apart until the next refresh?
bool apart(const Model& m, const State& s, const Unset<ExposedFace>& exposed, const Patch& a,
           const Patch& b) {
  const InMotion nodes{s.nodes.motion.data()};
  const Real room = farthest_contact(m.rules, a, b);
  const Vec3<Real> closing = last_step * (b.drift - a.drift);
  const auto range = [&](const Patch& p, const Vec3<Real>& n, const Vec3<Real>& c) {
    std::pair<Real, Real> r{1e300, -1e300};
    for (Index i = 0; i < p.vertex_count; ++i) {
      const Real up = dot(n, nodes.position(p.vertex[i]) - c);
      r = {std::min(r.first, up), std::max(r.second, up)};
    }
    return r;
  };
  for (const Patch* p : {&a, &b})
    for (Index f = 0; f < p->face_count; ++f) {
      const ExposedFace& face = exposed[p->face[f]];
      const auto of_a = range(a, face.normal, face.center);
      const auto of_b = range(b, face.normal, face.center);
      const Real closer = dot(face.normal, closing);
      if (of_b.first - of_a.second + std::min(closer, 0.0) > room ||
          of_a.first - of_b.second - std::max(closer, 0.0) > room)
        return true;
    }
  return false;
}

/// All vertices of x stay above the plane of y until the next refresh: they cannot touch.
bool apart(const SearchRules& rules, const ExposedFace& x, const ExposedFace& y) {
  Real lowest = 1e300, span2 = 0;
  for (Index k = 0; k < x.shape.count(); ++k) {
    const Vec3<Real> arm = x.shape.x[k] - y.center;
    lowest = std::min(lowest, dot(y.normal, arm));
    span2 = std::max(span2, dot(arm, arm));
  }
  if (lowest < 0) return false;
  const Real turned = y.turn * (std::sqrt(span2) + motion_between(x, y));
  return lowest + GapChange(x, y, y.normal).least > turned + y.warp + rules.lifted;
}

/// May anything of the two faces touch before the next refresh?
bool may_touch(const SearchRules& rules, const ExposedFace& x, const ExposedFace& y) {
  return x.block != y.block && (x.movable || y.movable) &&
         dot(x.normal, y.normal) < -rules.opposing + x.turn + y.turn && !apart(rules, x, y) &&
         !apart(rules, y, x);
}

/// Gap that a vertex of exposed face x at `v` may have to exposed face y until the next refresh.
struct GapRange {
  Real least, most;
  GapRange(const ExposedFace& x, const ExposedFace& y, const Vec3<Real>& v) {
    const Vec3<Real> arm = v - y.center;
    const GapChange change(x, y, y.normal);
    const Real gap = dot(y.normal, arm);
    const Real room = y.turn * (norm(arm) + motion_between(x, y)) + y.warp;
    least = gap + change.least - room;
    most = gap + change.most + room;
  }
};

/// May a contact with a face go on behind the corner at its side, where the surface rises (see
/// FindTargetFaces::behind_corner)?
bool may_go_behind(const Finder& f, const Vec3<Real>& v, const ExposedFace& x,
                   const ExposedSide& side) {
  return side.rises && GapRange(x, f.exposed[side.across], v).least <= 0;
}

/// May a vertex sink past the depth at which contacts with exposed face y begin, and be held there
/// (see FindTargetFaces::encloses)? `entry` is that depth, `length` L.
bool may_sink(const Finder& f, const Vec3<Real>& v, const ExposedFace& x, const ExposedFace& y,
              Index place_y, Real entry, Real length) {
  const GapRange gap(x, y, v);
  const Real deepest = std::min(f.m.rules.depth * length, 0.5 * f.m.face_height[y.face]);
  if (gap.least > -entry || gap.most < -deepest) return false;
  for (Index j = 0; j < y.shape.count(); ++j) {
    const ExposedSide& side = f.sides[4 * std::size_t(place_y) + j];
    if (side.across < 0) continue;
    const ExposedFace& u = f.exposed[side.across];
    const Vec3<Real> arm = u.center - y.center;
    const bool falls = dot(y.normal, arm) < -(y.turn + u.turn) * norm(arm);
    if (falls && GapRange(x, u, v).least > gap.most) return false;
  }
  return true;
}

/// Does a point that moves as exposed face x does stay beside exposed face y until the next refresh,
/// farther than `room` [m]? `v` is the vertex that it belongs to.
bool stays_beside(const Finder& f, const Vec3<Real>& v, const Vec3<Real>& point,
                  const ExposedFace& x, Index place_y, Real room) {
  const ExposedFace& y = f.exposed[place_y];
  for (Index j = 0; j < y.shape.count(); ++j) {
    const ExposedSide& side = f.sides[4 * std::size_t(place_y) + j];
    const Vec3<Real> from = point - side.start;
    if (dot(cross(y.normal, side.along), from) <
            -(room + 2 * y.turn * (norm(from) + room)) * side.length &&
        !may_go_behind(f, v, x, side))
      return true;
  }
  return false;
}

/// May a vertex of exposed face x come into contact with exposed face y before the next refresh?
/// The tests of FindTargetFaces::qualify with room for the motion; `reach` is that of the largest
/// of the faces at the vertex, `least` the L of the smallest. A vertex that a bond holds to y has
/// no contact there through its other faces too.
bool may_touch(const Finder& f, Index node, const ExposedFace& x, Real length, Real reach,
               Real least, Index place_y) {
  const ExposedFace& y = f.exposed[place_y];
  const SearchRules& rules = f.m.rules;
  const Real motion = motion_between(x, y);
  const GapChange change(x, y, y.normal);
  const Vec3<Real> v = f.faces.nodes.position(node), arm = v - y.center;
  const Real gap_room = y.turn * (norm(arm) + motion) + y.warp, gap = dot(y.normal, arm);
  if (gap + change.least > gap_room + rules.lifted ||
      gap + change.most < -rules.depth * length - gap_room)
    return false;
  if (stays_beside(f, v, v, x, place_y,
                   rules.tolerance * length + rules.indentation * reach + motion))
    return false;
  for (Index j = 0; j < y.shape.count(); ++j)
    if (f.faces.node_glue[f.faces.vertex(y.face, j)] == f.faces.node_glue[node]) return false;
  if (Bonded::among(f.bonded.vertices, node, place_y)) return false;
  if (may_sink(f, v, x, y, place_y, rules.entry * std::min(least, y.length), length)) return true;
  const Index point = f.faces.node_glue[node];  // never the deepest vertex?
  for (Index r = f.faces.ring_first[point]; r < f.faces.ring_first[point + 1]; ++r) {
    const Index other = f.faces.ring[r];
    if (f.s.search.node_watch[other] < 0) continue;
    const Vec3<Real> d = f.faces.nodes.position(other) - v;
    const Real moved = may_part(f.s, other, node);
    const Real long_d = norm(d), turn = 2 * moved / long_d + y.turn;
    if (dot(d, y.normal) < -(rules.cone + turn) * long_d) return false;
  }
  return true;
}

/// What of two patches stays beyond the reach of the other until the next refresh, seen along the
/// normals of their faces: no edge of it can touch, and no vertex that is outside the block. (Of
/// patches that a plane holds apart, this is everything: see above.)
///
/// A vertex that is inside a block may begin deeper than that, at the nearest face (see
/// FindTargetFaces). It is not beyond the reach of a patch that is a block by itself; what lies
/// beyond one that goes on behind may be inside of what it goes on as.
struct Beyond {
  // Which vertices lie on the far side of the other patch: two bits for each normal, one for either
  // end of it. What has its vertices on the same far side lies there as a whole.
  unsigned vertex[2][8] = {}, edge[2][12] = {};
  bool nothing_on[2][6];  // face: none of its vertices, nor of its edges
  bool no_vertex_on[2][6];

  Beyond(const Finder& f, const Patch& a, const Patch& b) {
    const Real room = farthest_contact(f.m.rules, a, b);
    const Vec3<Real> closing = last_step * (b.drift - a.drift);
    unsigned bit = 1;
    for (const Patch* p : {&a, &b})
      for (Index i = 0; i < p->face_count; ++i, bit <<= 2) {
        const Vec3<Real>& n = f.exposed[p->face[i]].normal;
        const Vec3<Real>& origin = f.exposed[p->face[i]].center;
        const Heights of_a(f, a, n, origin), of_b(f, b, n, origin);
        const Real closer = dot(n, closing);
        const Real up = room + std::max(closer, 0.0), down = room - std::min(closer, 0.0);
        for (Index v = 0; v < a.vertex_count; ++v)
          vertex[0][v] |= (of_a.at[v] - of_b.most > up ? bit : 0) |
                          (of_b.least - of_a.at[v] > down ? bit << 1 : 0);
        for (Index v = 0; v < b.vertex_count; ++v)
          vertex[1][v] |= (of_b.at[v] - of_a.most > down ? bit : 0) |
                          (of_a.least - of_b.at[v] > up ? bit << 1 : 0);
      }
    spread(a, 0, is_whole(b));
    spread(b, 1, is_whole(a));
  }
  /// Can nothing of two faces touch, of the first patch and of the second?
  bool hold_apart(Index x, Index y) const {
    return (nothing_on[0][x] && no_vertex_on[1][y]) || (nothing_on[1][y] && no_vertex_on[0][x]);
  }

 private:
  /// Of the vertices of a patch along a normal  [m].
  struct Heights {
    Real at[8], least = 1e300, most = -1e300;
    Heights(const Finder& f, const Patch& p, const Vec3<Real>& n, const Vec3<Real>& origin) {
      for (Index v = 0; v < p.vertex_count; ++v) {
        at[v] = dot(n, f.faces.nodes.position(p.vertex[v]) - origin);
        least = std::min(least, at[v]);
        most = std::max(most, at[v]);
      }
    }
  };
  /// Are all faces of the element behind a patch exposed?
  static bool is_whole(const Patch& p) {
    return p.face_count == (p.vertex_count == 4 ? 4 : p.vertex_count == 8 ? 6 : 5);
  }
  void spread(const Patch& p, int of, bool other_is_whole) {
    for (Index e = 0; e < p.edge_count; ++e)
      edge[of][e] = vertex[of][p.edge[e].vertex[0]] & vertex[of][p.edge[e].vertex[1]];
    for (Index v = 0; v < p.vertex_count && !other_is_whole; ++v) vertex[of][v] = 0;
    for (Index i = 0; i < p.face_count; ++i) {
      unsigned all = ~0u;
      no_vertex_on[of][i] = true;
      for (Index v = 0; v < p.vertex_count; ++v) {
        if (p.corner[v][i] < 0) continue;
        all &= vertex[of][v];
        no_vertex_on[of][i] = no_vertex_on[of][i] && vertex[of][v];
      }
      nothing_on[of][i] = all;
    }
  }
};

/// Which faces of two patches may touch, bit by bit: row = face of the first.
struct FacePairs {
  int row[6] = {};
  FacePairs(const Finder& f, const Patch& a, const Patch& b, const Beyond& beyond) {
    for (Index i = 0; i < a.face_count; ++i)
      for (Index j = 0; j < b.face_count; ++j)
        if (!beyond.hold_apart(i, j) &&
            may_touch(f.m.rules, f.exposed[a.face[i]], f.exposed[b.face[j]]) &&
            !Bonded::among(f.bonded.faces, a.face[i], b.face[j]))
          row[i] |= 1 << j;
  }
  bool any() const { return row[0] || row[1] || row[2] || row[3] || row[4] || row[5]; }
  /// The faces of the second that may touch one at an edge of the first, and the faces at an edge.
  int of(const Patch::Edge& e) const { return row[e.face[0]] | row[e.face[e.faces - 1]]; }
  static int at(const Patch::Edge& e) { return 1 << e.face[0] | 1 << e.face[e.faces - 1]; }
};

/// Corners and room of a vertex and a face that may touch; `length` and `least` as above, `indented`
/// is how far its indented points are from the vertex, at most.
Proximity::VertexFace vertex_face(const Finder& f, Index node, Index place_y, Real length,
                                  Real indented, Real least) {
  const SearchRules& rules = f.m.rules;
  const ExposedFace& y = f.exposed[place_y];
  const Real slack = 1e-6 * y.length;  // for round-off
  const Real above = (y.shape.count() == 3 ? 0 : 0.5 * y.length) + y.warp + slack;
  const Real aside = rules.tolerance * length + indented + slack;
  const Index last = y.shape.count() == 3 ? 2 : 3;
  const ExposedSide* sides = f.sides.data() + 4 * std::size_t(place_y);
  const bool behind = std::any_of(sides, sides + y.shape.count(),
                                  [](const ExposedSide& side) { return side.rises; });
  return {{node, f.faces.vertex(y.face, 0), f.faces.vertex(y.face, 1), f.faces.vertex(y.face, 2),
           f.faces.vertex(y.face, last)},
          {above + rules.lifted, above + rules.depth * length, aside,
           behind ? rules.entry * std::min(least, y.length) - slack : 1e30,
           1.34 * f.m.face_reach[y.face] + aside}};
}

/// Faces of two patches that lists have for each other, bit by bit: `row[reverse]`, with those of
/// the first patch as mothers, and then with those of the second.
struct Met {
  int row[2][6] = {};

  void add(bool reverse, Index mother, Index face) { row[reverse][mother] |= 1 << face; }
  void list(const Patch& a, const Patch& b, Proximity& found) const {
    for (Index i = 0; i < a.face_count; ++i)
      for (Index j = 0; j < b.face_count; ++j) {
        if (row[0][i] >> j & 1) found.meetings.push_back({a.face[i], b.face[j]});
        if (row[1][j] >> i & 1) found.meetings.push_back({b.face[j], a.face[i]});
      }
  }
};

/// Vertices of one patch on faces of another.
void list_touches(const Finder& f, const Patch& a, const Patch& b, const FacePairs& pairs,
                  const Beyond& beyond, bool reverse, Met& all_met, Proximity& found) {
  const auto met = [&](Index i, Index j) {
    return (reverse ? pairs.row[j] >> i : pairs.row[i] >> j) & 1;
  };
  for (Index j = 0; j < b.face_count; ++j) {
    for (Index v = 0; v < a.vertex_count; ++v) {
      if (beyond.vertex[reverse][v]) continue;
      Index first = -1;  // of the faces at the vertex
      Real least = 1e300;
      bool touches = false;  // already
      for (Index i = a.face_count - 1; i >= 0; --i)
        if (a.corner[v][i] >= 0 && met(i, j)) {
          first = i;
          least = std::min(least, f.exposed[a.face[i]].length);
          const std::size_t slot = 4 * std::size_t(a.face[i]) + a.corner[v][i];
          touches = touches || f.s.springs.target[slot] == b.face[j];
        }
      if (first < 0) continue;
      const Real length = std::min(a.length, f.exposed[b.face[j]].length);
      if (!touches &&
          !may_touch(f, a.vertex[v], f.exposed[a.face[first]], length, a.reach, least, b.face[j]))
        continue;
      const Vec3<Real> at = f.faces.nodes.position(a.vertex[v]);
      Real shift = 0;  // of the indented points
      for (Index i = 0; i < a.face_count; ++i) {
        if (a.corner[v][i] < 0 || !met(i, j)) continue;
        const ExposedFace &x = f.exposed[a.face[i]], &y = f.exposed[b.face[j]];
        const Vec3<Real> arm = x.center - at, indented = at + f.m.rules.indentation * arm;
        if (!touches && stays_beside(f, at, indented, x, b.face[j],
                                     f.m.rules.tolerance * length + motion_between(x, y)))
          continue;
        shift = std::max(shift, f.m.rules.indentation * (norm(arm) + 2 * x.stir));
        all_met.add(reverse, i, j);
        found.touches.push_back({a.face[i], a.corner[v][i], b.face[j], Index(found.faces.size())});
      }
      if (shift == 0) continue;  // nothing is listed
      found.faces.push_back(vertex_face(f, a.vertex[v], b.face[j], length, shift, least));
    }
  }
}

/// Is face y the right face of its side for a mother face x, or may it become so?
bool may_be_right(const Finder& f, const ExposedFace& x, const ExposedFace& y,
                  const ExposedSide& q) {
  const Real turns = 2 * (x.turn + y.turn) + q.turn_across;
  return q.across < 0 ||
         !(dot(x.normal, f.exposed[q.across].normal) < dot(x.normal, y.normal) - turns);
}

/// An edge, and how its ends may move until the next refresh.
struct MovingEdge {
  const ExposedFace* face;  // the first of those that meet there
  const ExposedSide* side;  // of it
  Index node[2], glue[2], place[2];
  Vec3<Real> end[2], path[2];         // [m]
  Vec3<Real> along;                   // from the first end to the second, of unit length
  Real length, skin[2], widest, turn; // [m], [m], the larger skin [m], [rad]
  Indented indented;

  MovingEdge(const Finder& f, const Patch& a, const Patch::Edge& edge)
      : face(&f.exposed[a.face[edge.face[0]]]),
        side(&f.sides[4 * std::size_t(a.face[edge.face[0]]) + edge.side[0]]),
        indented(edge.indented) {
    for (const int i : {0, 1}) {
      node[i] = a.vertex[edge.vertex[i]];
      glue[i] = f.faces.node_glue[node[i]];
      place[i] = f.faces.node_place[node[i]];
      const WatchedNode watched = WatchedNode::of(f.s, node[i]);
      end[i] = watched.position;
      path[i] = f.s.search.horizon * watched.velocity;
      skin[i] = watched.skin;
    }
    length = side->length;
    along = 1 / length * side->along;
    widest = std::max(skin[0], skin[1]);
    turn = (norm(path[1] - path[0]) + 2 * widest) / length;
  }
  Vec3<Real> path_at(Real at) const { return path[0] + at / length * (path[1] - path[0]); }
};

/// Those of a patch, each worked out once when it is asked for first.
class MovingEdges {
  const Finder& f;
  const Patch& patch;
  std::optional<MovingEdge> edge[12];

 public:
  MovingEdges(const Finder& finder, const Patch& of) : f(finder), patch(of) {}
  const MovingEdge& operator[](Index e) {
    if (!edge[e]) edge[e].emplace(f, patch, patch.edge[e]);
    return *edge[e];
  }
};

/// Ends of two edges, and which of them began at the same place in the mesh: bit 2 a + b of
/// `shared` for end a of the one and end b of the other.
struct SharedEnds {
  Index shared = 0;
  bool glued = false;   // intact bonds hold ends together
  Real parted = 1e300;  // how far the closest of the shared ends may part before the next refresh

  SharedEnds(const MovingEdge& p, const MovingEdge& q) {
    for (Index i = 0; i < 4; ++i) {
      const Index a = i >> 1, b = i & 1;
      glued = glued || p.glue[a] == q.glue[b];
      if (p.place[a] != q.place[b]) continue;
      shared |= 1 << i;
      parted = std::min(parted, norm(p.end[a] - q.end[b]) + norm(p.path[a] - q.path[b]) +
                                    p.skin[a] + q.skin[b]);
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
  Real gap;          // from the line of q to that of p along n  [m]
  Real turns, sine;  // what both may turn  [rad]; of the angle between them then, at least

  /// `cross` is that of the directions, of length `size`.
  TwoLines(const MovingEdge& one, const MovingEdge& other, const Vec3<Real>& cross, Real size)
      : p(one),
        q(other),
        n(1 / size * cross),
        gap(dot(n, p.end[0] - q.end[0])),
        turns(p.turn + q.turn),
        sine(size - turns) {}

  /// On which sides of each other the two may touch before the next refresh, as bits: 1 where the
  /// contact normal is n, 2 where it is -n. The tests of TouchTargetEdges with room for the motion.
  ///
  /// In contact the gap between the points that cross then is not positive along the normal n' of
  /// that time. They lie on n', so the gap of the same points along n was not positive either, but
  /// for how they move along n. (What little beyond its ends an edge may be crossed, see pass_by,
  /// turns with it.)
  int sides(const SearchRules& rules) const {
    const ExposedFace &x = *p.face, &y = *q.face;
    const ExposedSide &on_p = *p.side, &on_q = *q.side;
    const Real swing = turns / sine;  // of the normal
    const Real room = swing * std::max(p.indented.shift, q.indented.shift);
    const auto beyond = [&](Real sine_of_cone, const MovingEdge& of, Real turn_face) {
      return sine_of_cone < -(rules.cone + swing + of.turn + turn_face);
    };
    int found = 0;
    for (const int side : {1, 2}) {
      const Real way = side == 1 ? 1 : -1;
      if (way * gap + GapChange(x, y, way * n).least > room ||
          beyond(way * dot(n, on_p.fall), p, on_p.turn_face) ||
          beyond(-way * dot(n, on_q.fall), q, on_q.turn_face) ||
          (on_p.across >= 0 && beyond(way * dot(n, on_p.fall_across), p, on_p.turn_across)) ||
          (on_q.across >= 0 && beyond(-way * dot(n, on_q.fall_across), q, on_q.turn_across)))
        continue;
      found |= side;
    }
    return found;
  }

  /// Does the crossing of the lines stay off the ends of the edges until the next refresh, so that
  /// MarkNearEdges finds them far in every step?
  ///
  /// The line of an edge d (of unit length) crosses the other one between its ends x0 and x1 if
  /// these lie on different sides of it: (y - x) . (d x n) is the distance of an end from the line
  /// through y. It changes by no more than the end moves as seen from its foot on the line, and by
  /// its distance from the foot times what d and n turn.
  bool pass_by() const {
    const Indented edges = p.indented.and_of(q.indented);
    const Real cosine = std::min(1.0, std::abs(dot(p.along, q.along)) + turns);
    const Real inset = sine * edges.inset - cosine * edges.shift, beside = -edges.shift;
    const auto crosses = [&](Real on_p, Real on_q) {
      return (on_p > inset && on_q > beside) || (on_q > inset && on_p > beside);
    };
    const Ends of_p(p, q, n), of_q(q, p, n);
    if (crosses(of_p.inside(), of_q.inside())) return false;
    const Real round_off = 1e-6 * std::min(p.length, q.length), swing = turns / sine;
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
      const Real way = dot(on.along, across) < 0 ? -1 : 1;
      off[0] = way * dot(arm[0], across);
      off[1] = -way * dot(arm[1], across);
    }
    /// How far from the ends of the edge the line crosses it, times the sine of the angle.
    Real inside() const { return std::min(off[0], off[1]); }
    /// The same until the next refresh, at most.
    Real may_be_inside(Real swing) const {
      Real least = 1e300;
      for (const int i : {0, 1}) {
        const Real foot = -dot(arm[i], line.along), nearest = std::clamp(foot, 0.0, line.length);
        const Real motion = norm(on.path[i] - line.path_at(nearest)) + on.skin[i] + line.widest;
        const Real change = motion + line.turn * std::abs(foot - nearest) +
                            (line.turn + swing) * norm(arm[i] + foot * line.along);
        least = std::min(least, off[i] + change);
      }
      return least;
    }
  };
};

/// In which ways two edges may touch, see EdgePairs, as bits.
Index ways_to_touch(const Finder& f, const Patch& a, const Patch::Edge& p, const Patch& b,
                    const Patch::Edge& q, const FacePairs& pairs, const SharedEnds& ends, Met& met) {
  Index ways = 0;
  for (Index i = 0; i < p.faces; ++i)
    for (Index j = 0; j < q.faces; ++j) {
      if (!(pairs.row[p.face[i]] >> q.face[j] & 1)) continue;
      const Index face_p = a.face[p.face[i]], face_q = b.face[q.face[j]];
      const ExposedFace &x = f.exposed[face_p], &y = f.exposed[face_q];
      // ends that stay together are no edges on each other, see TouchTargetEdges
      if (ends.parted < f.m.rules.indentation * std::min(x.length, y.length)) continue;
      if (may_be_right(f, x, y, f.sides[4 * std::size_t(face_q) + q.side[j]])) {
        ways |= 1 << EdgePairs::way(false, i, j);
        met.add(false, p.face[i], q.face[j]);
      }
      if (may_be_right(f, y, x, f.sides[4 * std::size_t(face_p) + p.side[i]])) {
        ways |= 1 << EdgePairs::way(true, i, j);
        met.add(true, q.face[j], p.face[i]);
      }
    }
  return ways;
}

/// Was an edge in contact with another one a step ago?
bool in_contact(const Finder& f, const Patch& a, const Patch::Edge& p, Index edge) {
  const EdgeState& held = f.s.edges;
  for (Index i = 0; i < p.faces; ++i) {
    const Index x = a.face[p.face[i]];
    for (Index c = held.first[x]; c < held.first[x + 1]; ++c) {
      const EdgeContact contact = EdgeContact::at(held.contact.data(), c);
      if (contact.mother == 4 * x + p.side[i] && contact.edge == edge) return true;
    }
  }
  return false;
}

/// Two edges as MarkNearEdges sees them, on sides `on` of each other: those of their ends first
/// that began at the same place, if any. `ways` are those in which they may touch.
Proximity::Edges near_edges(const Finder& f, const Patch& a, Index e, const MovingEdge& p,
                            const Patch& b, Index g, const MovingEdge& q, const SharedEnds& ends,
                            int on, Index ways) {
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
  const Real way = on == 3 ? 0 : ((on == 1) != (first_p != first_q) ? 1 : -1);
  return {{p.node[first_p], p.node[1 - first_p], q.node[first_q], q.node[1 - first_q]},
          {1.000001 * rules.entry * std::min(a.length, b.length), edges.shift, way, edges.inset,
           ends.shared ? 0.999999 * rules.indentation * edges.length : 0},
          {a.edge_first + e, b.edge_first + g},
          EdgePairs::code_of(ways, SidePair::turned(ends.shared, first_p, first_q), sides)};
}

/// Edges of one patch across edges of another.
void list_edges(const Finder& f, const Patch& a, const Patch& b, const FacePairs& pairs,
                const Beyond& beyond, Met& met, Proximity& found) {
  const Real room = farthest_contact(f.m.rules, a, b) + last_step * norm(b.drift - a.drift);
  MovingEdges of_a(f, a), of_b(f, b);
  for (Index e = 0; e < a.edge_count; ++e) {
    const int opposite = pairs.of(a.edge[e]);
    if (beyond.edge[0][e] || !opposite) continue;
    const MovingEdge& p = of_a[e];
    if (!p.side->sharp) continue;
    for (Index g = 0; g < b.edge_count; ++g) {
      if (beyond.edge[1][g] || !(opposite & FacePairs::at(b.edge[g]))) continue;
      const MovingEdge& q = of_b[g];
      if (!q.side->sharp) continue;
      const Vec3<Real> normal = cross(p.along, q.along);
      const Real sine2 = dot(normal, normal), off = dot(normal, p.end[0] - q.end[0]);
      if (off * off > room * room * sine2) continue;  // so far are even the lines
      const SharedEnds ends(p, q);
      if (ends.glued) continue;
      // ends that stay together are no edges on each other, see TouchTargetEdges
      const Real together = f.m.rules.indentation;
      if (ends.parted < together * std::min(p.indented.length, q.indented.length)) continue;
      int on = 3;
      const Real sine = std::sqrt(sine2), turns = p.turn + q.turn;
      if (sine + turns < MarkNearEdges::parallel) continue;
      if (sine > turns) {
        const TwoLines lines(p, q, normal, sine);
        on = lines.sides(f.m.rules);
        if (!on) continue;
        if (lines.pass_by() && !in_contact(f, a, a.edge[e], b.edge[g].id) &&
            !in_contact(f, b, b.edge[g], a.edge[e].id))
          continue;
      } else if (distance2(p, q) > room * room) {
        continue;
      }
      const Index ways = ways_to_touch(f, a, a.edge[e], b, b.edge[g], pairs, ends, met);
      if (ways) found.edges.push_back(near_edges(f, a, e, p, b, g, q, ends, on, ways));
    }
  }
}

/// The sides at the edges of all patches, see EdgePairs; patches learn their places.
void list_edge_sides(Unset<Patch>& patches, Unset<Index>& sides) {
  Index count = 0;
  for (Patch& patch : patches) {
    patch.edge_first = count;
    count += patch.edge_count;
  }
  sides.resize(2 * std::size_t(count));
  const Index patch_count = Index(patches.size());
#pragma omp parallel for schedule(static, 128) if (patch_count >= worth_threads)
  for (Index p = 0; p < patch_count; ++p)
    for (Index e = 0; e < patches[p].edge_count; ++e) {
      const Patch::Edge& edge = patches[p].edge[e];
      for (Index i = 0; i < 2; ++i)
        sides[2 * std::size_t(patches[p].edge_first + e) + i] =
            i < edge.faces ? 4 * patches[p].face[edge.face[i]] + edge.side[i] : -1;
    }
}

}  // namespace

void find_proximity(const Model& m, const State& s, ProximitySearch& search) {
  Unset<ExposedFace>& exposed = search.exposed;
  Unset<ExposedSide>& sides = search.sides;
  Unset<Patch>& patches = search.patches;
  list_exposed_faces(m, s, exposed);
  list_exposed_sides(s, exposed, sides);
  list_patches(m, s, exposed, patches);
  const Bonded bonded = live_overlaps(m, s);
  const Finder f{m, s, face_columns(m, s), exposed, sides, bonded};
  const Index count = Index(patches.size());
  std::vector<Box> boxes(count);
  for (Index p = 0; p < count; ++p) boxes[p] = patches[p].box;
  const BoxTree tree(boxes);
  AllProximity& all = search.found;
  all.by_thread.resize(omp_get_max_threads());
  all.by_patch.assign(count, {});
  list_edge_sides(patches, all.edge_sides);
  for (Proximity& found : all.by_thread) found.clear();
#pragma omp parallel if (count >= worth_threads)
  {
    Proximity& found = all.by_thread[omp_get_thread_num()];
    std::vector<Index> others;
#pragma omp for schedule(dynamic, 32)
    for (Index p = 0; p < count; ++p) {
      const Patch& a = patches[p];
      if (!a.movable) continue;  // those that are near it find it
      others.clear();
      tree.query(boxes[p], [&](Index q) {
        if ((q > p || !patches[q].movable) && a.block != patches[q].block &&
            !apart(m, s, exposed, a, patches[q]))
          others.push_back(q);
      });
      std::sort(others.begin(), others.end());
      all.by_patch[p].begin(omp_get_thread_num(), found);
      for (const Index q : others) {
        const Patch& b = patches[q];
        const Beyond beyond(f, a, b);
        const FacePairs pairs(f, a, b, beyond);
        if (!pairs.any()) continue;
        Met met;
        list_touches(f, a, b, pairs, beyond, false, met, found);
        list_touches(f, b, a, pairs, beyond, true, met, found);
        if (m.semi_edges) list_edges(f, a, b, pairs, beyond, met, found);
        met.list(a, b, found);
      }
      all.by_patch[p].end(found);
    }
  }
}

bool pair_sides(const FaceColumns& faces, Index face_m, Index k, Index face_t, Index j,
                SidePair& pair) {
  const Index km = k + 1 == faces.vertex_count(face_m) ? 0 : k + 1;
  const Index jt = j + 1 == faces.vertex_count(face_t) ? 0 : j + 1;
  const Index mother[2] = {faces.vertex(face_m, k), faces.vertex(face_m, km)};
  const Index target[2] = {faces.vertex(face_t, j), faces.vertex(face_t, jt)};
  pair = {k, j, 0};
  for (Index i = 0; i < 4; ++i) {
    const Index a = mother[i >> 1], b = target[i & 1];
    if (faces.node_glue[a] == faces.node_glue[b]) return false;
    if (faces.node_place[a] == faces.node_place[b]) pair.shared |= 1 << i;
  }
  return true;
}

Bonded live_overlaps(const Model& m, const State& s) {
  Bonded bonded;
  for (Index i = 0; i < m.overlaps.count; ++i) {
    if (!(s.overlaps.live[i] > 0)) continue;
    for (Index side = 0; side < 2; ++side) {
      const Index face = m.overlaps.faces[2 * i + side];
      const Index mate = s.search.face_exposed[m.overlaps.faces[2 * i + 1 - side]];
      bonded.faces.push_back({s.search.face_exposed[face], mate});
      for (Index k = 0; k < 4; ++k) bonded.vertices.push_back({m.face_nodes[4 * face + k], mate});
    }
  }
  std::sort(bonded.faces.begin(), bonded.faces.end());
  std::sort(bonded.vertices.begin(), bonded.vertices.end());
  return bonded;
}

}  // namespace cdem
