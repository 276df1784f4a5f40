// element_patch.cpp - see element_patch.hpp.
#include "core/contact/broad_phase/element_patch.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/contact/broad_phase/predicted_motion.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// Data of exposed faces for the lists.
struct ElementSurface {
  const Model& m;
  const State& s;
  FaceColumns faces = on_host(face_columns(m, s));
  PredictedNodes predicted{s};
  OnHost<const Index> exposed_face = on_host(s.search.exposed_face),
                      target = on_host(s.springs.target), edge_first = on_host(s.edges.first),
                      block = on_host(m.face_block);
  OnHost<const Flag> movable = on_host(m.face_movable);
  OnHost<const Real> springs = on_host(s.springs.state), edges = on_host(s.edges.state),
                     area = on_host(m.face_area), reach = on_host(m.face_reach);
};

/// Deepest contact of a face: its targets may lie this far outside its path  [m].
Real deepest_gap(const ElementSurface& of, Index place) {
  Real deepest = 0;
  for (std::size_t k = 4 * std::size_t(place); k < 4 * std::size_t(place) + 4; ++k)
    if (of.target[k] >= 0) {
      const ContactState spring = ContactState::at(of.springs.data(), k);
      deepest = std::max(deepest, spring.depth() - spring.stress_free_gap);
    }
  for (Index c = of.edge_first[place]; c < of.edge_first[place + 1]; ++c) {
    const ContactState edge = ContactState::at(of.edges.data(), c);
    deepest = std::max(deepest, edge.depth() - edge.stress_free_gap);
  }
  return 2 * deepest;
}

ExposedFace exposed_face(const ElementSurface& of, Index place) {
  ExposedFace e;
  e.face = of.exposed_face[place];
  e.block = of.block[e.face];
  e.movable = of.movable[e.face] != 0;
  e.length = of.faces.face_length[e.face];
  e.shape = of.faces.shape(e.face);
  e.center = e.shape.center();
  e.normal = e.shape.normal();
  const Index count = e.shape.count();
  Vec3<Real> path[4], sum{0, 0, 0};
  Real node_skin[4];
  for (Index k = 0; k < count; ++k) {
    const PredictedNode node = of.predicted.at(of.faces.vertex(e.face, k));
    path[k] = of.s.search.outer.lookahead_time * node.velocity;
    node_skin[k] = node.skin;
    sum = sum + path[k];
  }
  e.displacement = Real(1.0) / Real(count) * sum;
  e.deviation = e.deviation_soon = e.warpage = 0;
  Real longest = 0, skin = 0;
  e.box = Box::nothing();
  for (Index k = 0; k < count; ++k) {
    skin = std::max(skin, node_skin[k]);
    const Real apart = norm(path[k] - e.displacement);
    e.deviation = std::max(e.deviation, apart + node_skin[k]);
    e.deviation_soon =
        std::max(e.deviation_soon, inner_horizon * apart + inner_skin * node_skin[k]);
    e.warpage = std::max(e.warpage, std::abs(dot(e.normal, e.shape.x[k] - e.center)));
    longest = std::max(longest, norm(e.shape.x[k + 1 == count ? 0 : k + 1] - e.shape.x[k]));
    e.box.include(e.shape.x[k]);
    e.box.include(e.shape.x[k] + path[k]);
  }
  e.warpage = count == 3 ? 0.0 : e.warpage + 2 * e.deviation;
  e.deepest = deepest_gap(of, place);
  e.box.inflate(skin + e.deepest + of.m.rules.lifted);
  // the plane rotates by the relative motion of two vertices over the smallest height
  const Real height = (count == 3 ? 2 : 1) * of.area[e.face] / longest;
  e.rotation = 2 * e.deviation / height;
  e.rotation_soon = 2 * e.deviation_soon / height;
  e.slender = longest / height;
  return e;
}

/// Effect of the indentation of a face at one of its sides.
Indented indented_at(const Model& m, const ExposedFace& face, Index side) {
  const Real part = m.rules.indentation;
  const Vec3<Real>& start = face.shape.x[side];
  const Vec3<Real> arm = face.center - start,
                   edge = face.shape.x[side + 1 == face.shape.count() ? 0 : side + 1] - start;
  const Real length = norm(edge), along = dot(arm, edge) / length;
  return {0.99 * part * std::min(along, length - along),
          1.01 * part * norm(cross(arm, edge)) / length, face.length};
}

/// All of a patch but its faces.
void complete(const ElementSurface& of, const Unset<ExposedFace>& exposed, Patch& p) {
  p.box = Box::nothing();
  for (Index i = 0; i < p.face_count; ++i) {
    const ExposedFace& e = exposed[p.face[i]];
    p.displacement = p.displacement + Real(1.0) / p.face_count * e.displacement;
    p.deepest = std::max(p.deepest, e.deepest);
    p.length = std::max(p.length, e.length);
    p.reach = std::max(p.reach, of.reach[e.face]);
    p.block = e.block;
    p.movable = e.movable;
    p.box.include(e.box);
    for (Index k = 0; k < e.shape.count(); ++k) {
      Index* end = p.vertex + p.vertex_count;
      const Index node = of.faces.vertex(e.face, k);
      const Index v = Index(std::find(p.vertex, end, node) - p.vertex);
      if (v == p.vertex_count) {
        p.vertex[p.vertex_count++] = node;
        std::fill_n(p.corner[v], 6, -1);
      }
      p.corner[v][i] = Patch::Place(k);
      const Index id = of.faces.face_edges[4 * e.face + k];
      Patch::Edge* last = p.edge + p.edge_count;
      Patch::Edge* edge = std::find_if(p.edge, last, [&](const auto& o) { return o.id == id; });
      if (edge == last) p.edge[p.edge_count++] = {.id = id};
      edge->face[edge->faces] = Patch::Place(i);
      edge->side[edge->faces++] = Patch::Place(k);
      edge->indented = edge->indented.and_of(indented_at(of.m, e, k));
    }
  }
  p.whole = p.face_count == (p.vertex_count == 4 ? 4 : p.vertex_count == 8 ? 6 : 5);
  if (!p.whole) p.box.inflate(of.m.rules.depth * p.length);  // see farthest_contact
  for (Index e = 0; e < p.edge_count; ++e) {
    Patch::Edge& edge = p.edge[e];
    const Index i = edge.face[0], count = exposed[p.face[i]].shape.count();
    for (Index v = 0; v < p.vertex_count; ++v)
      for (Index end = 0; end < 2; ++end)
        if (p.corner[v][i] == (edge.side[0] + end) % count) edge.vertex[end] = Patch::Place(v);
  }
  for (Index i = 0; i < p.face_count; ++i) {
    const ExposedFace& e = exposed[p.face[i]];
    p.deviation = std::max(p.deviation, norm(e.displacement - p.displacement) + e.deviation);
  }
}

}  // namespace

void list_exposed_faces(const Model& m, const State& s, Unset<ExposedFace>& exposed) {
  const ElementSurface surface{m, s};
  const Index count = Index(surface.exposed_face.size());
  exposed.resize(count);
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x) exposed[x] = exposed_face(surface, x);
}

void list_patches(const Model& m, const State& s, const Unset<ExposedFace>& exposed,
                  Unset<Patch>& patches) {
  Index element_count = 0;
  for_each_element_set(
      m, s, [&](auto, const ElementSet& e, const ElementState&) { element_count += e.count; });
  std::vector<Index> patch_of(element_count, -1);
  struct Faces {
    Index count, place[6];
  };
  std::vector<Faces> faces;
  const auto element = on_host(m.face_element);
  for (Index x = 0; x < Index(exposed.size()); ++x) {
    Index& patch = patch_of[element[exposed[x].face]];
    if (patch < 0) {
      patch = Index(faces.size());
      faces.push_back({});
    }
    faces[patch].place[faces[patch].count++] = x;
  }
  const Index count = Index(faces.size());
  patches.resize(count);
  const ElementSurface surface{m, s};
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index p = 0; p < count; ++p) {
    Patch& patch = patches[p] = {};
    patch.face_count = faces[p].count;
    std::copy_n(faces[p].place, faces[p].count, patch.face);
    complete(surface, exposed, patch);
  }
}

void list_exposed_sides(const State& s, const Unset<ExposedFace>& exposed,
                        Unset<ExposedSide>& sides) {
  sides.resize(4 * exposed.size());
  const auto beyond_sides = on_host(s.search.across), place = on_host(s.search.face_exposed);
#pragma omp parallel for schedule(static, 128) if (exposed.size() >= worth_threads)
  for (std::size_t x = 0; x < exposed.size(); ++x) {
    const ExposedFace& e = exposed[x];
    for (Index k = 0; k < e.shape.count(); ++k) {
      ExposedSide& side = sides[4 * x + k] = {};
      side.start = e.shape.x[k];
      side.along = e.shape.x[k + 1 == e.shape.count() ? 0 : k + 1] - side.start;
      side.length = norm(side.along);
      side.rotation = 2 * e.deviation / side.length;
      side.rotation_face = e.rotation;
      side.fall = unit(cross(e.normal, side.along));
      const Index across = beyond_sides[4 * x + k];
      side.across = across < 0 ? -1 : place[across];
      side.sharp = true;
      if (side.across < 0) continue;  // no neighbour, or an unexposed one
      const ExposedFace& beyond = exposed[side.across];
      side.rotation_across = beyond.rotation;
      side.fall_across = unit(cross(beyond.normal, -side.along));
      // the angle between the faces may change by the rotation of both
      const Real angle = std::acos(std::min(1.0, dot(e.normal, beyond.normal)));
      side.sharp = angle + e.rotation + beyond.rotation > std::acos(coplanar_faces);
      const Vec3<Real> arm = beyond.center - side.start;
      side.rises = side.sharp && dot(e.normal, arm) > -(e.rotation + beyond.rotation) * norm(arm);
    }
  }
}

}  // namespace cdem
