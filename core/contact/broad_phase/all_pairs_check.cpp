// all_pairs_check.cpp - see all_pairs_check.hpp.
#include "core/contact/broad_phase/all_pairs_check.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

#include "core/bonds/bonded_overlaps.hpp"
#include "core/contact/broad_phase/bounding_boxes.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/narrow_phase/side_pairs.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

/// Boxes of the sides of exposed faces, [exposed][4], with room for any depth of contact: sides
/// whose boxes are apart cannot touch.
std::vector<Box> side_boxes(const Model& m, const State& s) {
  const FaceColumns faces = face_columns(m, s);
  const Index count = Index(s.search.exposed_face.size());
  std::vector<Box> boxes(4 * std::size_t(count), Box::nothing());
  for (Index x = 0; x < count; ++x) {
    const Index face = s.search.exposed_face[x], corners = faces.vertex_count(face);
    for (Index k = 0; k < corners; ++k) {
      const Index ends[2] = {faces.vertex(face, k),
                             faces.vertex(face, k + 1 == corners ? 0 : k + 1)};
      Box& box = boxes[4 * std::size_t(x) + k];
      Real speed = 0;
      for (const Index node : ends) {
        box.include(faces.nodes.position(node));
        speed = std::max(speed, norm(faces.nodes.velocity(node)));
      }
      const Real slack = m.rules.indentation * 2 * m.face_reach[face];  // more than it is long
      box.inflate(m.rules.depth * m.face_length[face] + slack +
                  m.rules.approach_steps * faces.dt * speed);
    }
  }
  return boxes;
}

Index count_missed_contacts(const Model& m, State& s) {
  update_all_face_geometry(m, s, {});
  finish({});
  const ResolveTargets springs{face_search(m, s)};
  const ResolveTargetEdges edges = edge_search(m, s);
  const Index count = Index(s.search.exposed_face.size());
  const Bonded bonded = live_overlaps(m, s);
  const auto block = [&](Index x) { return m.face_block[s.search.exposed_face[x]]; };
  const auto movable = [&](Index x) { return m.face_movable[s.search.exposed_face[x]] != 0; };
  // spheres around two faces, with room for any depth of contact: what is farther off cannot touch
  const auto near = [&](Index x, Index t) {
    const Index face = s.search.exposed_face[x], other = s.search.exposed_face[t];
    const Vec3<Real> apart = springs.geometry.center(x) - springs.geometry.center(t);
    const Real reach =
        m.face_reach[face] + m.face_reach[other] + m.face_length[face] + m.face_length[other];
    return dot(apart, apart) < reach * reach;
  };
  const std::vector<Box> sides = side_boxes(m, s);
  Index missed = 0;
#pragma omp parallel for schedule(dynamic, 8) reduction(+ : missed)
  for (Index x = 0; x < count; ++x) {
    std::vector<Index> all, open;
    for (Index t = 0; t < count; ++t)
      if (block(t) != block(x) && (movable(t) || movable(x)) && near(x, t) &&
          !Bonded::among(bonded.faces, x, t))
        all.push_back(t);
    Flag ignored = 0;
    for (Index k = 0; k < springs.faces.vertex_count(s.search.exposed_face[x]); ++k) {
      const Index node = springs.faces.vertex(s.search.exposed_face[x], k);
      open.clear();
      std::copy_if(all.begin(), all.end(), std::back_inserter(open),
                   [&](Index t) { return !Bonded::among(bonded.vertices, node, t); });
      const FaceList list{open.data(), nullptr, Index(open.size())};
      missed += s.springs.target[4 * x + k] != springs.choose(x, k, list, &ignored);
    }
    if (!m.semi_edges) continue;
    const auto touch = [&](Index t, Index k, Index j) {
      SidePair pair;
      const Index face = s.search.exposed_face[x], other = s.search.exposed_face[t];
      if (!pair_sides(edges.faces, face, k, other, j, pair)) return false;
      const Index edge = m.face_edges[4 * other + j];
      return edges.test(TwoSides<Index>{x, t, pair.code(), edges.held_place(x, k, edge)}).touches;
    };
    const auto found = [&](Index t, Index k, Index j) {
      for (Index c = s.edges.first[x]; c < s.edges.first[x + 1]; ++c) {
        const EdgeContact contact = EdgeContact::at(s.edges.contact.data(), c);
        if (contact.mother == 4 * x + k && contact.face == t &&
            contact.edge == m.face_edges[4 * s.search.exposed_face[t] + j])
          return true;
      }
      return false;
    };
    Index known = 0;  // of those that are listed
    for (const Index t : all)
      for (Index k = 0; k < edges.faces.vertex_count(s.search.exposed_face[x]); ++k)
        for (Index j = 0; j < edges.faces.vertex_count(s.search.exposed_face[t]); ++j) {
          if (!sides[4 * std::size_t(x) + k].overlaps(sides[4 * std::size_t(t) + j])) continue;
          if (touch(t, k, j)) found(t, k, j) ? ++known : ++missed;
        }
    missed += s.edges.first[x + 1] - s.edges.first[x] - known;
  }
  return missed;
}

}  // namespace

void check_against_all_pairs(const Model& m, State& s) {
  const PhaseTimer timer(s, Phase::search);
  if (m.check_search) s.missed += count_missed_contacts(m, s);
}

}  // namespace cdem
