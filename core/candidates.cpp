// candidates.cpp - which faces and edges may touch before the lists are renewed.
//
// The lists foresee that every vertex goes straight on at its present velocity for a while, and
// they are good until one has strayed from there by its skin. So rock that moves as a whole needs
// no new lists. Every test below leaves room for that motion: what it rejects cannot come into
// contact before.
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

/// Velocity that the lists foresee for a node.
Vec3<Real> foreseen(const State& s, Index node) {
  const Real* v = s.nodes.built_motion.data() + std::size_t(node) * 8 + 4;
  return {v[0], v[1], v[2]};
}

/// Add to its nodes how every element of a set moves as a rigid body.
void add_rigid_motion(const ElementSet& e, Index corners, InMotion nodes,
                      std::vector<Vec3<Real>>& sum, std::vector<Real>& weight) {
  for (Index i = 0; i < e.count; ++i) {
    Index id[8];
    Vec3<Real> center{0, 0, 0}, velocity{0, 0, 0}, spin{0, 0, 0};
    bool moves = false;
    for (Index k = 0; k < corners; ++k) {
      id[k] = e.nodes[std::size_t(k) * e.stride + i];
      center = center + Real(1.0) / corners * nodes.position(id[k]);
      velocity = velocity + Real(1.0) / corners * nodes.velocity(id[k]);
      moves = moves || dot(nodes.velocity(id[k]), nodes.velocity(id[k])) > 0;
      weight[id[k]] += 1;
    }
    if (!moves) continue;
    Mat3<Real> inertia{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (Index k = 0; k < corners; ++k) {
      const Vec3<Real> arm = nodes.position(id[k]) - center;
      inertia = inertia + dot(arm, arm) * identity<Real>();
      add_outer(inertia, -arm, arm);
      spin = spin + cross(arm, nodes.velocity(id[k]));
    }
    spin = inverse(inertia) * spin;
    for (Index k = 0; k < corners; ++k) {
      const Vec3<Real> arm = nodes.position(id[k]) - center;
      sum[id[k]] = sum[id[k]] + velocity + cross(spin, arm);
    }
  }
}

/// Foresee where the nodes of exposed faces go, straight on with the rigid motion of their elements
/// (which leaves the elements' vibrations out), and how far they may stray from there: as far as
/// they would with the change of velocity that they had since the last refresh.
void foresee_motion(const Model& m, State& s) {
  constexpr Index fewest = 20, steps = 200;
  constexpr Real least = 0.001, most = 0.1;  // skin in parts of the smallest L of the node's faces
  constexpr Real period = 10;                // of vibrations, in steps
  // rubble that collides strays long before a far horizon, and would list ever more for nothing
  const std::int64_t lasted = s.built_step < 0 ? steps : s.step - s.built_step;
  const Index ahead = std::clamp<std::int64_t>(2 * lasted, fewest, steps);
  s.search.horizon = s.dt * (m.refresh_interval > 0 ? m.refresh_interval : ahead);
  s.search.built_time = s.time;
  std::vector<Vec3<Real>> sum(m.node_count, Vec3<Real>{0, 0, 0});
  std::vector<Real> weight(m.node_count);
  const InMotion nodes{s.nodes.motion.data()};
  add_rigid_motion(m.tet4, 4, nodes, sum, weight);
  add_rigid_motion(m.pyramid5, 5, nodes, sum, weight);
  add_rigid_motion(m.wedge6, 6, nodes, sum, weight);
  add_rigid_motion(m.hex8, 8, nodes, sum, weight);

  Column<Real>& skin = s.search.node_skin;
  skin.resize(m.node_count);
  skin.fill(0);
  for (std::size_t x = 0; x < s.search.exposed_face.size(); ++x)
    for (Index k = 0; k < 4; ++k) {
      const Index face = s.search.exposed_face[x], node = m.face_nodes[4 * face + k];
      if (node < 0) continue;
      const Real length = m.face_length[face];
      skin[node] = skin[node] > 0 ? std::min(skin[node], length) : length;
    }
#pragma omp parallel for schedule(static) if (m.node_count >= worth_threads)
  for (Index i = 0; i < m.node_count; ++i) {
    const Vec3<Real> x = nodes.position(i), v = Real(1.0) / weight[i] * sum[i];
    const Real stray =
        s.search.horizon * norm(v - foreseen(s, i)) + period * s.dt * norm(nodes.velocity(i) - v);
    Real* row = s.nodes.built_motion.data() + std::size_t(i) * 8;
    row[0] = x.x, row[1] = x.y, row[2] = x.z;
    row[4] = v.x, row[5] = v.y, row[6] = v.z;
    if (skin[i] > 0) skin[i] = std::clamp(stray, least * skin[i], most * skin[i]);
  }
}

/// Deepest contact of a face: its targets may lie this far outside its path  [m].
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

/// An exposed face as the lists see it: where it is, and how it may move before they are old.
struct ExposedFace {
  FaceShape shape;
  Vec3<Real> center, normal;
  Vec3<Real> drift;  // of all its vertices alike  [m]
  Real stir;         // of a vertex beyond the drift  [m]
  Real turn;         // of the normal and of the sides  [rad]
  Real deepest;      // contact  [m]
  Real warp;         // of a vertex out of the mean plane  [m]
  Real length;       // L  [m]
  Index face, block;
  bool movable;
  Box box;  // of the whole way
};

ExposedFace exposed_face(const Model& m, const State& s, Index place) {
  ExposedFace e;
  e.face = s.search.exposed_face[place];
  e.block = m.face_block[e.face];
  e.movable = m.face_movable[e.face] != 0;
  e.length = m.face_length[e.face];
  e.shape = face_columns(m, s).shape(e.face);
  e.center = e.shape.center();
  e.normal = e.shape.normal();
  const Index count = e.shape.count;
  Vec3<Real> path[4], sum{0, 0, 0};
  for (Index k = 0; k < count; ++k) {
    path[k] = s.search.horizon * foreseen(s, m.face_nodes[4 * e.face + k]);
    sum = sum + path[k];
  }
  e.drift = Real(1.0) / Real(count) * sum;
  e.stir = e.warp = 0;
  Real longest = 0, skin = 0;
  e.box = Box::nothing();
  for (Index k = 0; k < count; ++k) {
    const Real node_skin = s.search.node_skin[m.face_nodes[4 * e.face + k]];
    skin = std::max(skin, node_skin);
    e.stir = std::max(e.stir, norm(path[k] - e.drift) + node_skin);
    e.warp = std::max(e.warp, std::abs(dot(e.normal, e.shape.x[k] - e.center)));
    longest = std::max(longest, norm(e.shape.x[k + 1 == count ? 0 : k + 1] - e.shape.x[k]));
    e.box.include(e.shape.x[k]);
    e.box.include(e.shape.x[k] + path[k]);
  }
  e.warp = count == 3 ? 0.0 : e.warp + 2 * e.stir;
  e.deepest = deepest_gap(s, place);
  e.box.inflate(skin + e.deepest + m.rules.lifted);
  // the plane turns by what two vertices may move apart over the smallest height
  const Real height = (count == 3 ? 2 : 1) * m.face_area[e.face] / longest;
  e.turn = 2 * e.stir / height;
  return e;
}

/// How far a vertex of one face may move as seen from the other  [m].
Real motion_between(const ExposedFace& x, const ExposedFace& y) {
  return norm(x.drift - y.drift) + x.stir + y.stir;
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

/// All vertices of x stay above the plane of y until the next refresh: they cannot touch.
bool apart(const SearchRules& rules, const ExposedFace& x, const ExposedFace& y) {
  Real lowest = 1e300, span = 0;
  for (Index k = 0; k < x.shape.count; ++k) {
    const Vec3<Real> arm = x.shape.x[k] - y.center;
    lowest = std::min(lowest, dot(y.normal, arm));
    span = std::max(span, norm(arm));
  }
  const Real turned = y.turn * (span + motion_between(x, y));
  return lowest + GapChange(x, y, y.normal).least > turned + y.warp + rules.lifted;
}

/// May anything of the two faces touch before the next refresh?
bool may_touch(const SearchRules& rules, const ExposedFace& x, const ExposedFace& y) {
  return x.block != y.block && (x.movable || y.movable) &&
         dot(x.normal, y.normal) < -rules.opposing + x.turn + y.turn && !apart(rules, x, y) &&
         !apart(rules, y, x);
}

/// Which vertices of x may come into contact with exposed face y before the next refresh, bit by
/// bit: the tests of FindTargetFaces::qualify with room for the motion. A vertex that a bond holds
/// to y has no contact there through its other faces too.
int touching_vertices(const Model& m, const State& s, const Bonded& bonded,
                      const std::vector<ExposedFace>& exposed, Index place_x, Index place_y) {
  const ExposedFace &x = exposed[place_x], &y = exposed[place_y];
  const SearchRules& rules = m.rules;
  const Real motion = motion_between(x, y), length = std::min(x.length, y.length);
  const GapChange change(x, y, y.normal);
  const FaceColumns faces = face_columns(m, s);
  const auto glued = [&](Index node) {
    for (Index j = 0; j < y.shape.count; ++j)
      if (faces.node_glue[faces.vertex(y.face, j)] == faces.node_glue[node]) return true;
    return false;
  };
  const auto beside = [&](const Vec3<Real>& p) {
    for (Index j = 0; j < y.shape.count; ++j) {
      const Vec3<Real> a = y.shape.x[j], side = y.shape.x[j + 1 == y.shape.count ? 0 : j + 1] - a;
      const Vec3<Real> arm = p - a;
      const Real room = rules.tolerance * length + motion + 2 * y.turn * norm(arm);
      if (dot(cross(y.normal, side), arm) < -room * norm(side)) return true;
    }
    return false;
  };
  const auto never_deepest = [&](Index node, const Vec3<Real>& v) {
    const Index point = faces.node_glue[node];
    for (Index r = faces.ring_first[point]; r < faces.ring_first[point + 1]; ++r) {
      const Index other = faces.ring[r];
      if (s.search.node_skin[other] == 0) continue;  // nothing watches its motion
      const Vec3<Real> d = faces.nodes.position(other) - v;
      const Real moved = s.search.horizon * norm(foreseen(s, other) - foreseen(s, node)) +
                         s.search.node_skin[other] + s.search.node_skin[node];
      const Real long_d = norm(d), turn = 2 * moved / long_d + y.turn;
      if (dot(d, y.normal) < -(rules.cone + turn) * long_d) return true;
    }
    return false;
  };
  int mask = 0;
  for (Index k = 0; k < x.shape.count; ++k) {
    const Vec3<Real> v = x.shape.x[k], arm = v - y.center;
    const Real room = y.turn * (norm(arm) + motion) + y.warp, gap = dot(y.normal, arm);
    if (gap + change.least > room + rules.lifted ||
        gap + change.most < -rules.depth * length - room)
      continue;
    if (beside(v + rules.indentation * (x.center - v))) continue;
    const Index node = faces.vertex(x.face, k);
    if (glued(node) || Bonded::among(bonded.vertices, node, place_y) || never_deepest(node, v))
      continue;
    mask |= 1 << k;
  }
  return mask;
}

/// Shortest vector from the segment b + t e to the segment a + s d, with s and t in 0..1.
Vec3<Real> between_segments(const Vec3<Real>& a, const Vec3<Real>& d, const Vec3<Real>& b,
                            const Vec3<Real>& e) {
  const Vec3<Real> apart = a - b;
  const Real dd = dot(d, d), ee = dot(e, e), de = dot(d, e);
  const Real da = dot(d, apart), ea = dot(e, apart), det = dd * ee - de * de;
  const auto limit = [](Real x) { return std::clamp(x, 0.0, 1.0); };
  Real s = det > 1e-12 * dd * ee ? limit((de * ea - ee * da) / det) : 0.0;
  const Real t = limit((de * s + ea) / ee);
  s = limit((de * t - da) / dd);
  return apart + s * d - t * e;
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

std::vector<ExposedSide> exposed_sides(const State& s, const std::vector<ExposedFace>& exposed) {
  std::vector<ExposedSide> sides(4 * exposed.size());
#pragma omp parallel for schedule(static, 128) if (exposed.size() >= worth_threads)
  for (std::size_t x = 0; x < exposed.size(); ++x) {
    const ExposedFace& e = exposed[x];
    for (Index k = 0; k < e.shape.count; ++k) {
      ExposedSide& side = sides[4 * x + k];
      side.start = e.shape.x[k];
      side.along = e.shape.x[k + 1 == e.shape.count ? 0 : k + 1] - side.start;
      side.length = norm(side.along);
      side.turn = 2 * e.stir / side.length;
      side.turn_face = e.turn;
      side.fall = unit(cross(e.normal, side.along));
      const Index across = s.search.across[4 * x + k];
      side.across = across < 0 ? -1 : s.search.face_exposed[across];
      side.sharp = true;
      if (side.across < 0) continue;  // none, or one whose motion nothing watches
      const ExposedFace& beyond = exposed[side.across];
      side.turn_across = beyond.turn;
      side.fall_across = unit(cross(beyond.normal, -side.along));
      // the angle between the faces may change by what both may turn
      const Real angle = std::acos(std::min(1.0, dot(e.normal, beyond.normal)));
      side.sharp = angle + e.turn + beyond.turn > std::acos(coplanar_faces);
    }
  }
  return sides;
}

/// Can the two sides never be each other's edges until the next refresh? The tests of
/// FindTargetEdges with room for the motion. `apart` leads from q to p.
bool never_cross(const SearchRules& rules, const ExposedFace& x, const ExposedSide& p,
                 const ExposedFace& y, const ExposedSide& q, const Vec3<Real>& apart) {
  const Real turns = p.turn_face + q.turn_face;
  const Vec3<Real> c = cross(p.along, q.along);
  const Real sine = norm(c) / (p.length * q.length) - p.turn - q.turn;
  if (!(sine > 0)) return false;
  const Real swing = (p.turn + q.turn) / sine;  // of the contact normal
  const Vec3<Real> out = y.normal - x.normal;
  const Real side = dot(c, out) / norm(c);
  if (std::abs(side) < 2 * swing + turns) return false;  // either sign may come
  const Vec3<Real> n = (side < 0 ? -1 : 1) / norm(c) * c;
  const GapChange change(x, y, n);
  const Real swung = swing * (norm(apart) + motion_between(x, y)), gap = dot(n, apart);
  if (gap + change.least > swung) return true;
  const auto beyond = [&](Real sine_of_cone, const ExposedSide& of, Real turn_face) {
    return sine_of_cone < -(rules.cone + swing + of.turn + turn_face);
  };
  return beyond(dot(n, p.fall), p, p.turn_face) || beyond(-dot(n, q.fall), q, q.turn_face) ||
         (p.across >= 0 && beyond(dot(n, p.fall_across), p, p.turn_across)) ||
         (q.across >= 0 && beyond(-dot(n, q.fall_across), q, q.turn_across));
}

/// Do ends of the two sides that began at one place stay there until the next refresh? Then
/// FindTargetEdges takes them for no edges on each other.
bool stay_together(const Model& m, const State& s, const ExposedFace& x, const ExposedFace& y,
                   const SidePair& pair) {
  if (!pair.shared) return false;
  const FaceColumns faces = face_columns(m, s);
  const Real near = m.rules.indentation * std::min(x.length, y.length);
  for (Index i = 0; i < 4; ++i) {
    if (!(pair.shared >> i & 1)) continue;
    const Index a = faces.vertex(x.face, (pair.k + (i >> 1)) % x.shape.count);
    const Index b = faces.vertex(y.face, (pair.j + (i & 1)) % y.shape.count);
    const Real motion = s.search.horizon * norm(foreseen(s, a) - foreseen(s, b)) +
                        s.search.node_skin[a] + s.search.node_skin[b];
    if (norm(faces.nodes.position(a) - faces.nodes.position(b)) + motion < near) return true;
  }
  return false;
}

/// What one exposed face may touch before the next refresh.
struct Row {
  struct Touch {
    Index face;
    int vertices;  // bit by bit
  };
  struct Crossing {
    Index face, sides;
  };
  std::vector<Touch> touches;
  std::vector<Crossing> crossings;
};

void list_crossings(const Model& m, const State& s, const std::vector<ExposedFace>& exposed,
                    const std::vector<ExposedSide>& sides, Index x, Index y, Row& row) {
  const ExposedFace &face_x = exposed[x], &face_y = exposed[y];
  // what both may move (and in the last step 1.5 times again), how deep a contact may be, and the
  // indentation: the indented side, which decides, is that far from the true one
  const Real room = 1.05 * motion_between(face_x, face_y) + face_x.deepest + face_y.deepest +
                    m.rules.entry * std::min(face_x.length, face_y.length) +
                    2 * m.rules.indentation * m.face_reach[face_x.face];
  bool right[4];  // is y the right face of its side j, or may it become so?
  for (Index j = 0; j < face_y.shape.count; ++j) {
    const ExposedSide& q = sides[4 * std::size_t(y) + j];
    const Real turns = 2 * (face_x.turn + face_y.turn) + q.turn_across;
    right[j] = q.sharp && !(q.across >= 0 && dot(face_x.normal, exposed[q.across].normal) <
                                                 dot(face_x.normal, face_y.normal) - turns);
  }
  for (Index k = 0; k < face_x.shape.count; ++k) {
    const ExposedSide& p = sides[4 * std::size_t(x) + k];
    if (!p.sharp) continue;
    for (Index j = 0; j < face_y.shape.count; ++j) {
      const ExposedSide& q = sides[4 * std::size_t(y) + j];
      if (!right[j]) continue;
      const Vec3<Real> normal = cross(p.along, q.along);
      const Real off = dot(normal, p.start - q.start);
      if (off * off > room * room * dot(normal, normal)) continue;  // so far are even the lines
      const Vec3<Real> apart = between_segments(p.start, p.along, q.start, q.along);
      SidePair pair;
      if (dot(apart, apart) > room * room ||
          !pair_sides(face_columns(m, s), face_x.face, k, face_y.face, j, pair) ||
          stay_together(m, s, face_x, face_y, pair) ||
          never_cross(m.rules, face_x, p, face_y, q, apart))
        continue;
      row.crossings.push_back({y, pair.code()});
    }
  }
}

std::vector<Row> find_rows(const Model& m, const State& s) {
  const Index count = Index(s.search.exposed_face.size());
  std::vector<ExposedFace> exposed(count);
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x) exposed[x] = exposed_face(m, s, x);
  const std::vector<ExposedSide> sides = exposed_sides(s, exposed);
  const Bonded bonded = live_overlaps(m, s);
  std::vector<Box> boxes(count);
  for (Index x = 0; x < count; ++x) boxes[x] = exposed[x].box;
  const BoxTree tree(boxes);
  std::vector<Row> rows(count);
#pragma omp parallel for schedule(dynamic, 64) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x) {
    std::vector<Index> near;
    tree.query(boxes[x], [&](Index y) {
      if (may_touch(m.rules, exposed[x], exposed[y]) && !Bonded::among(bonded.faces, x, y))
        near.push_back(y);
    });
    std::sort(near.begin(), near.end());
    for (const Index y : near) {
      const int vertices = touching_vertices(m, s, bonded, exposed, x, y);
      if (vertices) rows[x].touches.push_back({y, vertices});
      if (m.semi_edges) list_crossings(m, s, exposed, sides, x, y, rows[x]);
    }
  }
  return rows;
}

/// For every exposed face the others that list it: their contacts may act on it.
void list_sources(State& s, const std::vector<Row>& rows) {
  const Index count = Index(rows.size());
  Column<Index>&first = s.search.source_first, &source = s.search.source;
  first.resize(count + 1);
  first.fill(0);
  const auto visit = [&](auto&& at) {
    for (Index x = 0; x < count; ++x) {
      auto touch = rows[x].touches.begin();
      auto crossing = rows[x].crossings.begin();
      while (touch != rows[x].touches.end() || crossing != rows[x].crossings.end()) {
        // both are in ascending order
        const Index y = touch == rows[x].touches.end() ? crossing->face
                        : crossing == rows[x].crossings.end()
                            ? touch->face
                            : std::min(touch->face, crossing->face);
        at(y, x);
        while (touch != rows[x].touches.end() && touch->face == y) ++touch;
        while (crossing != rows[x].crossings.end() && crossing->face == y) ++crossing;
      }
    }
  };
  visit([&](Index y, Index) { ++first[y + 1]; });
  for (Index y = 0; y < count; ++y) first[y + 1] += first[y];
  source.resize(first[count]);
  std::vector<Index> next(first.data(), first.data() + count);
  visit([&](Index y, Index x) { source[next[y]++] = x; });
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

void list_candidates(const Model& m, State& s) {
  foresee_motion(m, s);
  const std::vector<Row> rows = find_rows(m, s);
  const Index count = Index(rows.size());
  Column<Index>&first = s.search.candidate_first, &other = s.search.candidate;
  Column<Index>& crossing_first = s.search.edge_candidate_first;
  first.resize(4 * std::size_t(count) + 1);
  crossing_first.resize(count + 1);
  first[0] = crossing_first[0] = 0;
  for (Index x = 0; x < count; ++x) {
    Index touching[4] = {};
    for (const Row::Touch& t : rows[x].touches)
      for (Index k = 0; k < 4; ++k) touching[k] += t.vertices >> k & 1;
    for (Index k = 0; k < 4; ++k) first[4 * x + k + 1] = first[4 * x + k] + touching[k];
    crossing_first[x + 1] = crossing_first[x] + Index(rows[x].crossings.size());
  }
  other.resize(first[4 * std::size_t(count)]);
  s.search.edge_candidate.resize(crossing_first[count]);
  s.search.edge_candidate_sides.resize(crossing_first[count]);
  for (Index x = 0; x < count; ++x) {
    for (Index k = 0; k < 4; ++k) {
      Index place = first[4 * x + k];
      for (const Row::Touch& t : rows[x].touches)
        if (t.vertices >> k & 1) other[place++] = t.face;
    }
    Index place = crossing_first[x];
    for (const Row::Crossing& c : rows[x].crossings) {
      s.search.edge_candidate[place] = c.face;
      s.search.edge_candidate_sides[place++] = c.sides;
    }
  }
  list_sources(s, rows);
}

void list_contact_corners(const Model& m, State& s) {
  Column<Index>&first = s.search.contact_first, &corner = s.search.contact_corner;
  first.resize(m.node_count + 1);
  first.fill(0);
  const auto visit = [&](auto&& at) {
    for (std::size_t x = 0; x < s.search.exposed_face.size(); ++x) {
      const Index face = s.search.exposed_face[x];
      for (Index k = 0; k < 4; ++k)
        if (m.face_nodes[4 * face + k] >= 0) at(m.face_nodes[4 * face + k], Index(4 * x) + k);
    }
  };
  visit([&](Index node, Index) { ++first[node + 1]; });
  for (Index i = 0; i < m.node_count; ++i) first[i + 1] += first[i];
  corner.resize(first[m.node_count]);
  std::vector<Index> next(first.data(), first.data() + m.node_count);
  visit([&](Index node, Index row) { corner[next[node]++] = row; });
}

}  // namespace cdem
