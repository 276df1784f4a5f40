// exposed.cpp - where exposed faces are, and how they may move before the lists are renewed.
#include "core/exposed.hpp"

#include <algorithm>
#include <cmath>

#include "core/columns.hpp"

namespace cdem {

namespace {

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

/// Deepest contact of a face: its targets may lie this far outside its path  [m].
Real deepest_gap(const State& s, Index place) {
  Real deepest = 0;
  for (std::size_t k = 4 * std::size_t(place); k < 4 * std::size_t(place) + 4; ++k)
    if (s.springs.target[k] >= 0) {
      const ContactState spring = ContactState::at(s.springs.state.data(), k);
      deepest = std::max(deepest, spring.sunk - spring.gap_free);
    }
  for (Index c = s.edges.first[place]; c < s.edges.first[place + 1]; ++c) {
    const ContactState edge = ContactState::at(s.edges.state.data(), c);
    deepest = std::max(deepest, edge.sunk - edge.gap_free);
  }
  return 2 * deepest;
}

ExposedFace exposed_face(const Model& m, const State& s, Index place) {
  ExposedFace e;
  e.face = s.search.exposed_face[place];
  e.block = m.face_block[e.face];
  e.movable = m.face_movable[e.face] != 0;
  e.length = m.face_length[e.face];
  e.shape = face_columns(m, s).shape(e.face);
  e.center = e.shape.center();
  e.normal = e.shape.normal();
  const Index count = e.shape.count();
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

/// All of a patch but its faces.
void complete(const Model& m, const State& s, const std::vector<ExposedFace>& exposed, Patch& p) {
  const FaceColumns faces = face_columns(m, s);
  for (Index i = 0; i < p.face_count; ++i) {
    const ExposedFace& e = exposed[p.face[i]];
    p.drift = p.drift + Real(1.0) / p.face_count * e.drift;
    p.deepest = std::max(p.deepest, e.deepest);
    p.length = std::max(p.length, e.length);
    p.reach = std::max(p.reach, m.face_reach[e.face]);
    p.block = e.block;
    p.movable = e.movable;
    p.box.include(e.box);
    for (Index k = 0; k < e.shape.count(); ++k) {
      Index* end = p.vertex + p.vertex_count;
      const Index node = faces.vertex(e.face, k);
      const Index v = Index(std::find(p.vertex, end, node) - p.vertex);
      if (v == p.vertex_count) {
        p.vertex[p.vertex_count++] = node;
        std::fill_n(p.corner[v], 6, -1);
      }
      p.corner[v][i] = k;
      const Index id = m.face_edges[4 * e.face + k];
      Patch::Edge* last = p.edge + p.edge_count;
      Patch::Edge* edge = std::find_if(p.edge, last, [&](const auto& o) { return o.id == id; });
      if (edge == last) p.edge[p.edge_count++] = {id, 0, {}, {}};
      edge->face[edge->faces] = i;
      edge->side[edge->faces++] = k;
    }
  }
  for (Index i = 0; i < p.face_count; ++i) {
    const ExposedFace& e = exposed[p.face[i]];
    p.stir = std::max(p.stir, norm(e.drift - p.drift) + e.stir);
  }
}

}  // namespace

Vec3<Real> foreseen(const State& s, Index node) {
  const Real* v = s.nodes.built_motion.data() + std::size_t(node) * 8 + 4;
  return {v[0], v[1], v[2]};
}

/// Smallest skin of a node, in parts of the smallest L of its faces: wide skins make long lists,
/// thin ones lists that do not last. Both cost about the same where lists last some twenty steps.
Real least_skin(const State& s, std::int64_t lasted) {
  constexpr Index short_lived = 16, long_lived = 32;
  constexpr Real thinnest = 0.001, widest = 0.03, change = 1.5;
  if (s.search.strayed && lasted < short_lived)
    return std::min(change * s.search.skin_least, widest);
  if (lasted > long_lived) return std::max(s.search.skin_least / change, thinnest);
  return s.search.skin_least;
}

void foresee_motion(const Model& m, State& s) {
  constexpr Index fewest = 20, steps = 200;
  constexpr Real most = 0.1;   // skin in parts of the smallest L of the node's faces
  constexpr Real period = 10;  // of vibrations, in steps
  // rubble that collides strays long before a far horizon, and would list ever more for nothing
  const std::int64_t lasted = s.built_step < 0 ? steps : s.step - s.built_step;
  const Real least = s.search.skin_least = least_skin(s, lasted);
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
  list_watched(s);
}

void list_watched(State& s) {
  s.search.watched.resize(0);
  for (Index i = 0; i < Index(s.search.node_skin.size()); ++i)
    if (s.search.node_skin[i] > 0) s.search.watched.push(i);
  const Index count = Index(s.search.watched.size());
  s.search.watch.resize(8 * std::size_t(count));
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index w = 0; w < count; ++w) {
    const std::size_t i = s.search.watched[w];
    Real* row = s.search.watch.data() + 8 * std::size_t(w);
    std::copy_n(s.nodes.built_motion.data() + 8 * i, 8, row);
    row[3] = s.search.node_skin[i] * s.search.node_skin[i];
  }
}

std::vector<ExposedFace> exposed_faces(const Model& m, const State& s) {
  const Index count = Index(s.search.exposed_face.size());
  std::vector<ExposedFace> exposed(count);
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x) exposed[x] = exposed_face(m, s, x);
  return exposed;
}

std::vector<Patch> exposed_patches(const Model& m, const State& s,
                                   const std::vector<ExposedFace>& exposed) {
  std::vector<Index> patch_of(m.tet4.count + m.pyramid5.count + m.wedge6.count + m.hex8.count, -1);
  std::vector<Patch> patches;
  for (Index x = 0; x < Index(exposed.size()); ++x) {
    Index& place = patch_of[m.face_element[exposed[x].face]];
    if (place < 0) {
      place = Index(patches.size());
      patches.emplace_back();
    }
    Patch& patch = patches[place];
    patch.face[patch.face_count++] = x;
  }
  const Index count = Index(patches.size());
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index p = 0; p < count; ++p) complete(m, s, exposed, patches[p]);
  return patches;
}

std::vector<ExposedSide> exposed_sides(const State& s, const std::vector<ExposedFace>& exposed) {
  std::vector<ExposedSide> sides(4 * exposed.size());
#pragma omp parallel for schedule(static, 128) if (exposed.size() >= worth_threads)
  for (std::size_t x = 0; x < exposed.size(); ++x) {
    const ExposedFace& e = exposed[x];
    for (Index k = 0; k < e.shape.count(); ++k) {
      ExposedSide& side = sides[4 * x + k];
      side.start = e.shape.x[k];
      side.along = e.shape.x[k + 1 == e.shape.count() ? 0 : k + 1] - side.start;
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
      const Vec3<Real> arm = beyond.center - side.start;
      side.rises = side.sharp && dot(e.normal, arm) > -(e.turn + beyond.turn) * norm(arm);
    }
  }
  return sides;
}

}  // namespace cdem
