// exposed_patches.hpp - kernels that make exposed faces, their sides and the patches of elements.
#pragma once

#include "core/base/elementary.hpp"
#include "core/base/parallel.hpp"
#include "core/contact/broad_phase/element_patch.hpp"
#include "core/contact/broad_phase/predicted_node.hpp"
#include "core/contact/geometry/face_geometry.hpp"
#include "core/records/contact_records.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// Exposed faces and their contacts.
struct ElementSurface {
  FaceColumns faces;
  PredictedNodes predicted;
  Real lookahead_time;  // [s]
  SearchRules rules;
  const Index *exposed_face, *block;  // [exposed], [face]
  const Flag* movable;                // [face]
  const Real *area, *reach;           // [face]  [m2], [m]
  const Index *target, *edge_first;   // [slot], [exposed + 1]
  const Real *springs, *edges;        // rows of ContactState

  /// Deepest contact of a face: its targets may lie this far outside its path  [m].
  CDEM_HD Real deepest_gap(Index place) const {
    Real deepest = 0;
    for (std::size_t k = 4 * std::size_t(place); k < 4 * std::size_t(place) + 4; ++k)
      if (target[k] >= 0) {
        const ContactState spring = ContactState::at(springs, k);
        deepest = max_of(deepest, spring.depth() - spring.stress_free_gap);
      }
    for (Index c = edge_first[place]; c < edge_first[place + 1]; ++c) {
      const ContactState edge = ContactState::at(edges, c);
      deepest = max_of(deepest, edge.depth() - edge.stress_free_gap);
    }
    return 2 * deepest;
  }
};

/// Make the exposed faces.
struct MakeExposedFaces {
  ElementSurface of;
  ExposedFace* exposed;

  CDEM_HD void operator()(One place) const {
    ExposedFace& e = exposed[place.i];
    e.face = of.exposed_face[place.i];
    e.block = of.block[e.face];
    e.movable = of.movable[e.face] != 0;
    e.length = of.faces.face_length[e.face];
    e.shape = of.faces.shape(e.face);
    e.center = e.shape.center();
    e.normal = e.shape.normal();
    e.deepest = of.deepest_gap(place.i);
    set_motion(e);
  }

 private:
  CDEM_HD void set_motion(ExposedFace& e) const {
    const Index count = e.shape.count();
    Vec3<Real> path[4], sum{0, 0, 0};
    Real node_skin[4];
    for (Index k = 0; k < count; ++k) {
      const PredictedNode node = of.predicted.at(of.faces.vertex(e.face, k));
      path[k] = of.lookahead_time * node.velocity;
      node_skin[k] = node.skin;
      sum = sum + path[k];
    }
    e.displacement = Real(1.0) / Real(count) * sum;
    e.deviation = e.deviation_soon = e.warpage = 0;
    Real longest = 0, skin = 0;
    e.box = Box::nothing();
    for (Index k = 0; k < count; ++k) {
      skin = max_of(node_skin[k], skin);
      const Real apart = norm(path[k] - e.displacement);
      e.deviation = max_of(apart + node_skin[k], e.deviation);
      e.deviation_soon =
          max_of(inner_horizon * apart + inner_skin * node_skin[k], e.deviation_soon);
      e.warpage = max_of(abs_of(dot(e.normal, e.shape.x[k] - e.center)), e.warpage);
      longest = max_of(norm(e.shape.x[k + 1 == count ? 0 : k + 1] - e.shape.x[k]), longest);
      e.box.include(e.shape.x[k]);
      e.box.include(e.shape.x[k] + path[k]);
    }
    e.warpage = count == 3 ? 0.0 : e.warpage + 2 * e.deviation;
    e.box.inflate(skin + e.deepest + of.rules.lifted);
    // the plane rotates by the relative motion of two vertices over the smallest height
    const Real height = (count == 3 ? 2 : 1) * of.area[e.face] / longest;
    e.rotation = 2 * e.deviation / height;
    e.rotation_soon = 2 * e.deviation_soon / height;
    e.slender = longest / height;
  }
};

/// Make the sides of exposed faces, [exposed][4].
struct MakeExposedSides {
  const ExposedFace* exposed;
  const Index *beyond, *face_exposed;  // [exposed][4] face across a side, or -1; see FaceColumns
  ExposedSide* sides;

  CDEM_HD void operator()(One x) const {
    for (Index k = 0; k < exposed[x.i].shape.count(); ++k) make(x.i, k);
  }

 private:
  CDEM_HD void make(Index x, Index k) const {
    const ExposedFace& e = exposed[x];
    ExposedSide& side = sides[4 * std::size_t(x) + k];
    side.start = e.shape.x[k];
    side.along = e.shape.x[k + 1 == e.shape.count() ? 0 : k + 1] - side.start;
    side.length = norm(side.along);
    side.rotation = 2 * e.deviation / side.length;
    side.rotation_face = e.rotation;
    side.rotation_across = 0;
    side.fall = unit(cross(e.normal, side.along));
    side.fall_across = {0, 0, 0};
    const Index across = beyond[4 * std::size_t(x) + k];
    side.across = across < 0 ? -1 : face_exposed[across];
    side.sharp = true;
    side.rises = false;
    if (side.across < 0) return;  // no neighbour, or an unexposed one
    const ExposedFace& other = exposed[side.across];
    side.rotation_across = other.rotation;
    side.fall_across = unit(cross(other.normal, -side.along));
    side.sharp = may_bend(dot(e.normal, other.normal), e.rotation + other.rotation);
    const Vec3<Real> arm = other.center - side.start;
    side.rises = side.sharp && dot(e.normal, arm) > -(e.rotation + other.rotation) * norm(arm);
  }
  /// May the angle between two faces, of which this is the cosine, exceed that of coplanar faces
  /// after rotations by so much [rad]?
  CDEM_HD static bool may_bend(Real cosine, Real rotations) {
    constexpr Real even[] = {1.0, -1.0 / 2, 1.0 / 24, -1.0 / 720, 1.0 / 40320};  // of the cosine
    const Real least = coplanar_angle - rotations;
    return least < 0 || cosine < polynomial(even, least * least);
  }
};

/// Is an exposed face the first of its element? Faces of an element follow each other.
struct BeginsPatch {
  const Index *exposed_face, *face_element;

  CDEM_HD bool operator()(One x) const {
    return x.i == 0 || face_element[exposed_face[x.i]] != face_element[exposed_face[x.i - 1]];
  }
};

/// Make the patches, but for the places of their edges among those of all.
struct MakePatches {
  ElementSurface of;
  const ExposedFace* exposed;
  const Index* first;    // [patch] its first exposed face
  Index patches, faces;  // how many there are
  Patch* list;
  Index* edge_count;  // [patch]

  CDEM_HD void operator()(One place) const {
    Patch& p = list[place.i];
    const Index last = place.i + 1 == patches ? faces : first[place.i + 1];
    p.face_count = last - first[place.i];
    for (Index i = 0; i < p.face_count; ++i) p.face[i] = first[place.i] + i;
    add_faces(p);
    p.whole = p.face_count == (p.vertex_count == 4 ? 4 : p.vertex_count == 8 ? 6 : 5);
    if (!p.whole) p.box.inflate(of.rules.depth * p.length);  // see farthest_contact
    for (Index e = 0; e < p.edge_count; ++e) find_ends(p, p.edge[e]);
    p.deviation = 0;
    for (Index i = 0; i < p.face_count; ++i) {
      const ExposedFace& e = exposed[p.face[i]];
      p.deviation = max_of(norm(e.displacement - p.displacement) + e.deviation, p.deviation);
    }
    edge_count[place.i] = p.edge_count;
  }

 private:
  CDEM_HD void add_faces(Patch& p) const {
    p.vertex_count = p.edge_count = 0;
    p.displacement = {0, 0, 0};
    p.far = false;
    p.deepest = p.length = p.reach = 0;
    p.box = Box::nothing();
    for (Index i = 0; i < p.face_count; ++i) {
      const ExposedFace& e = exposed[p.face[i]];
      p.displacement = p.displacement + Real(1.0) / p.face_count * e.displacement;
      p.deepest = max_of(e.deepest, p.deepest);
      p.length = max_of(e.length, p.length);
      p.reach = max_of(of.reach[e.face], p.reach);
      p.block = e.block;
      p.movable = e.movable;
      p.box.include(e.box);
      for (Index k = 0; k < e.shape.count(); ++k) {
        add_vertex(p, i, k, of.faces.vertex(e.face, k));
        add_edge(p, i, k, of.faces.face_edges[4 * e.face + k], e);
      }
    }
  }
  CDEM_HD static void add_vertex(Patch& p, Index i, Index k, Index node) {
    const Index v = p.vertex_at(node);
    if (v == p.vertex_count) {
      p.vertex[p.vertex_count++] = node;
      for (Patch::Place& corner : p.corner[v]) corner = -1;
    }
    p.corner[v][i] = Patch::Place(k);
  }
  CDEM_HD void add_edge(Patch& p, Index i, Index k, Index id, const ExposedFace& e) const {
    Patch::Edge& edge = p.edge[p.edge_at(id)];
    if (&edge == p.edge + p.edge_count) {
      edge.id = id;
      edge.faces = 0;
      edge.face[1] = edge.side[1] = 0;
      edge.indented = Indented::none();
      ++p.edge_count;
    }
    edge.face[edge.faces] = Patch::Place(i);
    edge.side[edge.faces++] = Patch::Place(k);
    edge.indented = edge.indented.and_of(indented_at(e, k));
  }
  /// Effect of the indentation of a face at one of its sides.
  CDEM_HD Indented indented_at(const ExposedFace& face, Index side) const {
    const Real part = of.rules.indentation;
    const Vec3<Real>& start = face.shape.x[side];
    const Vec3<Real> arm = face.center - start,
                     edge = face.shape.x[side + 1 == face.shape.count() ? 0 : side + 1] - start;
    const Real length = norm(edge), along = dot(arm, edge) / length;
    return {0.99 * part * min_of(along, length - along),
            1.01 * part * norm(cross(arm, edge)) / length, face.length};
  }
  CDEM_HD void find_ends(const Patch& p, Patch::Edge& edge) const {
    const Index i = edge.face[0], count = exposed[p.face[i]].shape.count();
    for (Index v = 0; v < p.vertex_count; ++v)
      for (Index end = 0; end < 2; ++end)
        if (p.corner[v][i] == (edge.side[0] + end) % count) edge.vertex[end] = Patch::Place(v);
  }
};

/// List the sides at the edges of all patches, see EdgePairs; patches get the places of theirs.
struct ListEdgeSides {
  const Index* first;  // [patch] of its edges
  Patch* patches;
  Index* sides;  // [edge][2]

  CDEM_HD void operator()(One place) const {
    Patch& p = patches[place.i];
    p.edge_first = first[place.i];
    for (Index e = 0; e < p.edge_count; ++e)
      for (Index i = 0; i < 2; ++i) {
        const Patch::Edge& edge = p.edge[e];
        sides[2 * std::size_t(p.edge_first + e) + i] =
            i < edge.faces ? 4 * p.face[edge.face[i]] + edge.side[i] : -1;
      }
  }
};

/// Copy a number of every exposed face that later kernels need.
struct CopyRotations {
  const ExposedFace* exposed;
  Real* rotation_soon;
  CDEM_HD void operator()(One x) const { rotation_soon[x.i] = exposed[x.i].rotation_soon; }
};

/// Copy the boxes of patches.
struct CopyBoxes {
  const Patch* patches;
  Box* boxes;
  CDEM_HD void operator()(One p) const { boxes[p.i] = patches[p.i].box; }
};

}  // namespace cdem
