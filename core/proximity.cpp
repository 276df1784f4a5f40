// proximity.cpp - pairs of patches, and which vertices of them may touch before the lists are
// renewed.
#include "core/proximity.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/columns.hpp"
#include "core/contact/boxes.hpp"
#include "core/near_edges.hpp"
#include "core/patch_pair.hpp"

namespace cdem {

namespace {

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

/// Does a point that moves as exposed face x does stay beside exposed face y until the next
/// refresh, farther than `room` [m]? `v` is the vertex that it belongs to.
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

/// Room of a vertex and a face that may touch; `length` and `least` as above,
/// `indented` is how far its indented points are from the vertex, at most, and `stir` how far its
/// faces are strained and turned as long as the close lists hold.
///
/// In contact the vertex is at a point of the face but for the depth and for `off` beside it, more
/// behind a corner (or from the centre of a warped face), of which the turn of the face changes
/// what is seen along its sides, or its normal.
Proximity::VertexFace vertex_face(const Finder& f, Index node, Index place_y, Real length,
                                  Real indented, Real stir, Real least) {
  const SearchRules& rules = f.m.rules;
  const ExposedFace& y = f.exposed[place_y];
  const Real slack = 1e-6 * y.length;  // for round-off
  const Real above = (y.shape.count() == 3 ? 0 : 0.5 * y.length) + y.warp + slack;
  const Real aside = rules.tolerance * length + indented + slack;
  const Index last = y.shape.count() == 3 ? 2 : 3;
  const ExposedSide* sides = f.sides.data() + 4 * std::size_t(place_y);
  const bool behind = std::any_of(sides, sides + y.shape.count(),
                                  [](const ExposedSide& side) { return side.rises; });
  const Real reach = 1.34 * f.m.face_reach[y.face] + aside;
  const Real off =
      behind ? 2 * reach : std::max(2 * aside * y.slender, last == 3 ? 0.5 * reach : 0.0);
  Real parted = 0;
  for (Index k = 0; k <= last; ++k)
    parted = std::max(parted, ways_part_soon(f.s, node, f.faces.vertex(y.face, k)));
  const Real motion = parted + rules.indentation * 2 * stir + 2 * y.turn_soon * off + slack;
  return {{node, place_y},
          {above + rules.lifted + motion, above + rules.depth * length + motion, aside + motion,
           behind ? std::max(rules.entry * std::min(least, y.length) - slack - motion, 0.0) : 1e30,
           reach + motion, motion}};
}

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
      Real shift = 0, stir = 0;  // of the indented points
      for (Index i = 0; i < a.face_count; ++i) {
        if (a.corner[v][i] < 0 || !met(i, j)) continue;
        const ExposedFace &x = f.exposed[a.face[i]], &y = f.exposed[b.face[j]];
        const Vec3<Real> arm = x.center - at, indented = at + f.m.rules.indentation * arm;
        if (!touches && stays_beside(f, at, indented, x, b.face[j],
                                     f.m.rules.tolerance * length + motion_between(x, y)))
          continue;
        shift = std::max(shift, f.m.rules.indentation * (norm(arm) + 2 * x.stir));
        stir = std::max(stir, x.stir_soon);
        all_met.add(reverse, i, j);
        found.touches.push_back({a.face[i], a.corner[v][i], b.face[j], Index(found.faces.size())});
      }
      if (shift == 0) continue;  // nothing is listed
      found.faces.push_back(vertex_face(f, a.vertex[v], b.face[j], length, shift, stir, least));
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
