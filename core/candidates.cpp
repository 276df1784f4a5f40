// candidates.cpp - which faces and edges may touch before the lists are renewed.
//
// A list is good until some vertex has moved by its face's skin, so every test below leaves room
// for that motion: what it rejects cannot come into contact before.
#include "core/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/columns.hpp"
#include "core/contact/boxes.hpp"
#include "core/contact/target_edge.hpp"

namespace cdem {

namespace {

using Pairs = std::vector<std::pair<Index, Index>>;

/// How much an exposed face may move before the lists are old  [m]: what it will move in some
/// hundred steps at its present speed. Slow rubble so gets short lists, fast rubble few refreshes.
Real skin_of(const Model& m, const State& s, Index face) {
  constexpr Real steps = 200, least = 0.004, most = 0.1;  // parts of the face's L
  Real speed = 0;
  for (Index k = 0; k < 4; ++k) {
    const Index node = m.face_nodes[4 * face + k];
    if (node < 0) continue;
    const Real* v = s.nodes.motion.data() + std::size_t(node) * 8 + 4;
    speed = std::max(speed, std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
  }
  const Real length = m.face_length[face];
  return std::clamp(steps * s.dt * speed, least * length, most * length);
}

/// Deepest contact of a face: its targets may lie this far outside its skin  [m].
Real deepest_gap(const State& s, Index place) {
  Real deepest = 0;
  for (std::size_t k = 4 * std::size_t(place); k < 4 * std::size_t(place) + 4; ++k)
    if (s.springs.target[k] >= 0)
      deepest = std::max(deepest, s.springs.sunk[k] - s.springs.gap_free[k]);
  for (Index j = 0; j < s.edges.count[place]; ++j) {
    const std::size_t c = std::size_t(s.edges.slots) * place + j;
    deepest = std::max(deepest, s.edges.sunk[c] - s.edges.gap_free[c]);
  }
  return 2 * deepest;
}

/// Faces of the same live pair, as sorted keys: bonds look after them.
Pairs live_overlaps(const Model& m, const State& s) {
  Pairs mates;
  for (Index i = 0; i < m.overlaps.count; ++i) {
    if (!(s.overlaps.live[i] > 0)) continue;
    const Index a = s.search.face_exposed[m.overlaps.faces[2 * i]];
    const Index b = s.search.face_exposed[m.overlaps.faces[2 * i + 1]];
    mates.push_back({a, b});
    mates.push_back({b, a});
  }
  std::sort(mates.begin(), mates.end());
  return mates;
}

struct ExposedFaces {
  std::vector<Box> box;
  std::vector<Vec3<Real>> normal;
  std::vector<Real> turn;  // how much the normal may turn before the lists are old
  std::vector<Index> block;
  std::vector<Flag> movable;
  std::vector<FaceShape> shape;
  std::vector<Real> skin;   // how far a vertex may move before the lists are old  [m]
  std::vector<Real> reach;  // of the box around the face  [m]

  /// All vertices of x stay above the plane of y until the next refresh: they cannot touch.
  bool apart(Index x, Index y) const {
    const Vec3<Real> center = shape[y].center();
    Real lowest = 1e300, span = 0;
    for (Index k = 0; k < shape[x].count; ++k) {
      const Vec3<Real> arm = shape[x].x[k] - center;
      lowest = std::min(lowest, dot(normal[y], arm));
      span = std::max(span, norm(arm));
    }
    const Real bend = shape[y].count == 4 ? reach[y] : 0;  // a warped face is no plane
    return lowest > reach[x] + reach[y] + turn[y] * span + bend;
  }
};

ExposedFaces exposed_faces(const Model& m, const State& s) {
  const Index count = Index(s.search.exposed_face.size());
  const FaceColumns faces = face_columns(m, s);
  ExposedFaces e{std::vector<Box>(count),  std::vector<Vec3<Real>>(count),
                 std::vector<Real>(count), std::vector<Index>(count),
                 std::vector<Flag>(count), std::vector<FaceShape>(count),
                 std::vector<Real>(count), std::vector<Real>(count)};
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x) {
    const Index face = s.search.exposed_face[x];
    const FaceShape f = faces.shape(face);
    Box box = Box::nothing();
    Real longest = 0;
    for (Index k = 0; k < f.count; ++k) {
      box.include(f.x[k]);
      longest = std::max(longest, norm(f.x[k + 1 == f.count ? 0 : k + 1] - f.x[k]));
    }
    e.shape[x] = f;
    const Real skin = skin_of(m, s, face);
    e.skin[x] = skin;
    e.reach[x] = skin + deepest_gap(s, x);
    box.inflate(e.reach[x]);
    e.box[x] = box;
    e.normal[x] = f.normal();
    // vertices move by a skin at most: the plane turns by twice that over the smallest height
    const Real height = (f.count == 3 ? 2 : 1) * m.face_area[face] / longest;
    e.turn[x] = 2 * skin / height;
    e.block[x] = m.face_block[face];
    e.movable[x] = m.face_movable[face];
  }
  return e;
}

void list_faces(const Model& m, State& s, const ExposedFaces& e) {
  const Index count = Index(s.search.exposed_face.size());
  const Pairs mates = live_overlaps(m, s);
  const BoxTree tree(e.box);
  std::vector<std::vector<Index>> rows(count);
#pragma omp parallel for schedule(dynamic, 256) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x) {
    tree.query(e.box[x], [&](Index y) {
      if (e.block[x] == e.block[y] || (!e.movable[x] && !e.movable[y])) return;
      if (dot(e.normal[x], e.normal[y]) >= -m.rules.opposing + e.turn[x] + e.turn[y]) return;
      if (e.apart(x, y) || e.apart(y, x)) return;
      if (!mates.empty() && std::binary_search(mates.begin(), mates.end(), std::pair(x, y))) return;
      rows[x].push_back(y);
    });
    std::sort(rows[x].begin(), rows[x].end());
  }
  Column<Index>&first = s.search.candidate_first, &other = s.search.candidate;
  first.resize(count + 1);
  first[0] = 0;
  for (Index x = 0; x < count; ++x) first[x + 1] = first[x] + Index(rows[x].size());
  other.resize(first[count]);
  for (Index x = 0; x < count; ++x)
    std::copy(rows[x].begin(), rows[x].end(), other.data() + first[x]);
}

/// Smallest distance of two straight segments a + s d, b + t e, with s and t in 0..1.
Real segment_distance(const Vec3<Real>& a, const Vec3<Real>& d, const Vec3<Real>& b,
                      const Vec3<Real>& e) {
  const Vec3<Real> apart = a - b;
  const Real dd = dot(d, d), ee = dot(e, e), de = dot(d, e);
  const Real da = dot(d, apart), ea = dot(e, apart), det = dd * ee - de * de;
  const auto limit = [](Real x) { return std::clamp(x, 0.0, 1.0); };
  Real s = det > 1e-12 * dd * ee ? limit((de * ea - ee * da) / det) : 0.0;
  const Real t = limit((de * s + ea) / ee);
  s = limit((de * t - da) / dd);
  return norm(apart + s * d - t * e);
}

/// A side of an exposed face. The faces that meet there fall away from a contact: its normal must
/// lie between theirs, which is what `fall` tells (see FindTargetEdges::cones_hold).
struct ExposedSide {
  bool sharp = false;  // may be an edge of a contact: its faces are not coplanar
  Vec3<Real> start, along;
  Vec3<Real> fall, fall_across;  // normal x side, of the face and of the one across
  Index across = -1;             // exposed face on the other side, or -1
  Real length = 0;               // [m]
  Real turn = 0, turn_face = 0, turn_across = 0;  // of the side and of both faces
};

std::vector<ExposedSide> exposed_sides(const Model& m, const State& s, const ExposedFaces& e) {
  const Index count = Index(s.search.exposed_face.size());
  std::vector<ExposedSide> sides(4 * std::size_t(count));
#pragma omp parallel for schedule(static, 128) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x) {
    const Index face = s.search.exposed_face[x];
    for (Index k = 0; k < e.shape[x].count; ++k) {
      ExposedSide& side = sides[4 * std::size_t(x) + k];
      side.start = e.shape[x].x[k];
      side.along = e.shape[x].x[k + 1 == e.shape[x].count ? 0 : k + 1] - side.start;
      side.length = norm(side.along);
      side.turn = 2 * e.skin[x] / side.length;
      side.turn_face = e.turn[x];
      side.fall = unit(cross(e.normal[x], side.along));
      const Index edge = m.face_edges[4 * face + k];
      const Index a = m.edge_faces[2 * edge], b = m.edge_faces[2 * edge + 1];
      const Index across = a == face ? b : a;
      side.across = across < 0 ? -1 : s.search.face_exposed[across];
      side.sharp = true;
      if (side.across < 0) continue;  // none, or one whose motion nothing watches
      side.turn_across = e.turn[side.across];
      side.fall_across = unit(cross(e.normal[side.across], -side.along));
      // the angle between the faces may change by what both may turn
      const Real angle = std::acos(std::min(1.0, dot(e.normal[x], e.normal[side.across])));
      side.sharp = angle + e.turn[x] + side.turn_across > std::acos(coplanar_faces);
    }
  }
  return sides;
}

/// Can the two sides never be each other's edges until the next refresh, wherever they are? The
/// tests of FindTargetEdges on directions, with room for what everything may turn.
bool turned_away(const SearchRules& rules, const ExposedFaces& e, Index x, const ExposedSide& p,
                 Index y, const ExposedSide& q) {
  const Vec3<Real>&normal_x = e.normal[x], &normal_y = e.normal[y];
  const Real turns = p.turn_face + q.turn_face;
  if (q.across >= 0 &&
      dot(normal_x, e.normal[q.across]) < dot(normal_x, normal_y) - 2 * turns - q.turn_across)
    return true;  // the face across is the right face of that edge
  if (dot(normal_x, normal_y) < flush_faces + turns) return false;
  const Vec3<Real> c = cross(p.along, q.along);
  const Real sine = norm(c) / (p.length * q.length) - p.turn - q.turn;
  if (!(sine > 0)) return false;
  const Real swing = (p.turn + q.turn) / sine;  // of the contact normal
  const Vec3<Real> out = normal_y - normal_x;
  const Real side = dot(c, out) / norm(c);
  if (std::abs(side) < 2 * swing + turns) return false;  // either sign may come
  const Vec3<Real> n = (side < 0 ? -1 : 1) / norm(c) * c;
  const auto beyond = [&](Real sine_of_cone, const ExposedSide& of, Real turn_face) {
    return sine_of_cone < -(rules.cone + swing + of.turn + turn_face);
  };
  return beyond(dot(n, p.fall), p, p.turn_face) || beyond(-dot(n, q.fall), q, q.turn_face) ||
         (p.across >= 0 && beyond(dot(n, p.fall_across), p, p.turn_across)) ||
         (q.across >= 0 && beyond(-dot(n, q.fall_across), q, q.turn_across));
}

void list_edges(const Model& m, State& s, const ExposedFaces& e) {
  const Index count = m.semi_edges ? Index(s.search.exposed_face.size()) : 0;
  const FaceColumns faces = face_columns(m, s);
  const std::vector<ExposedSide> sides = exposed_sides(m, s, e);
  struct Entry {
    Index face, sides;
  };
  std::vector<std::vector<Entry>> rows(count);
#pragma omp parallel for schedule(dynamic, 64) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x) {
    const Index face_x = s.search.exposed_face[x];
    for (Index c = s.search.candidate_first[x]; c < s.search.candidate_first[x + 1]; ++c) {
      const Index y = s.search.candidate[c], face_y = s.search.exposed_face[y];
      // what both may move, how deep a contact may begin, and the indentation, which decides
      const Real room = e.reach[x] + e.reach[y] +
                        m.rules.entry * std::min(m.face_length[face_x], m.face_length[face_y]) +
                        2 * m.rules.indentation * (m.face_reach[face_x] + m.face_reach[face_y]);
      for (Index k = 0; k < e.shape[x].count; ++k) {
        const ExposedSide& p = sides[4 * std::size_t(x) + k];
        if (!p.sharp) continue;
        for (Index j = 0; j < e.shape[y].count; ++j) {
          const ExposedSide& q = sides[4 * std::size_t(y) + j];
          if (!q.sharp || segment_distance(p.start, p.along, q.start, q.along) > room) continue;
          SidePair pair;
          if (!pair_sides(faces, face_x, k, face_y, j, pair)) continue;
          if (!turned_away(m.rules, e, x, p, y, q)) rows[x].push_back({y, pair.code()});
        }
      }
    }
  }
  Column<Index>& first = s.search.edge_candidate_first;
  first.resize(count + 1);
  first[0] = 0;
  for (Index x = 0; x < count; ++x) first[x + 1] = first[x] + Index(rows[x].size());
  s.search.edge_candidate.resize(first[count]);
  s.search.edge_candidate_sides.resize(first[count]);
  for (Index x = 0; x < count; ++x)
    for (std::size_t i = 0; i < rows[x].size(); ++i) {
      s.search.edge_candidate[first[x] + i] = rows[x][i].face;
      s.search.edge_candidate_sides[first[x] + i] = rows[x][i].sides;
    }
}

}  // namespace

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

void list_candidates(const Model& m, State& s) {
  const ExposedFaces e = exposed_faces(m, s);
  list_faces(m, s, e);
  list_edges(m, s, e);
}

void list_contact_corners(const Model& m, State& s) {
  Column<Index>&first = s.search.contact_first, &corner = s.search.contact_corner;
  first.resize(m.node_count + 1);
  first.fill(0);
  s.search.node_skin.resize(m.node_count);
  s.search.node_skin.fill(0);
  const auto visit = [&](auto&& at) {
    for (std::size_t x = 0; x < s.search.exposed_face.size(); ++x) {
      const Index face = s.search.exposed_face[x];
      for (Index k = 0; k < 4; ++k)
        if (m.face_nodes[4 * face + k] >= 0) at(m.face_nodes[4 * face + k], Index(4 * x) + k, face);
    }
  };
  visit([&](Index node, Index, Index face) {
    ++first[node + 1];
    Real& skin = s.search.node_skin[node];
    skin = skin > 0 ? std::min(skin, skin_of(m, s, face)) : skin_of(m, s, face);
  });
  for (Index i = 0; i < m.node_count; ++i) first[i + 1] += first[i];
  corner.resize(first[m.node_count]);
  std::vector<Index> next(first.data(), first.data() + m.node_count);
  visit([&](Index node, Index row, Index) { corner[next[node]++] = row; });
}

}  // namespace cdem
