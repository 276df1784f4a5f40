// all_pairs_check.cpp - see all_pairs_check.hpp.
#include "core/contact/broad_phase/all_pairs_check.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

#include "core/bonds/bonded_overlaps.hpp"
#include "core/contact/broad_phase/bounding_boxes.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/narrow_phase/side_pairs.hpp"
#include "core/contact/narrow_phase/soft_rim.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

/// Boxes of the sides of exposed faces, [exposed][4], with room for any depth of contact: sides
/// whose boxes are apart cannot touch.
std::vector<Box> side_boxes(const Model& m, const State& s) {
  const FaceColumns faces = on_host(face_columns(m, s));
  const auto exposed_face = on_host(s.search.exposed_face);
  const auto reach = on_host(m.face_reach);
  const Index count = Index(exposed_face.size());
  std::vector<Box> boxes(4 * std::size_t(count), Box::nothing());
  for (Index x = 0; x < count; ++x) {
    const Index face = exposed_face[x], corners = faces.vertex_count(face);
    for (Index k = 0; k < corners; ++k) {
      const Index ends[2] = {faces.vertex(face, k),
                             faces.vertex(face, k + 1 == corners ? 0 : k + 1)};
      Box& box = boxes[4 * std::size_t(x) + k];
      Real speed = 0;
      for (const Index node : ends) {
        box.include(faces.nodes.position(node));
        speed = std::max(speed, norm(faces.nodes.velocity(node)));
      }
      const Real slack = m.rules.indentation * 2 * reach[face];  // more than it is long
      box.inflate(m.rules.depth * faces.face_length[face] + slack +
                  m.rules.approach_steps * faces.dt * speed);
    }
  }
  return boxes;
}

/// Compares the contacts of every exposed face with the contacts found by a search of all others.
class AllPairs {
 public:
  AllPairs(const Model& model, State& state)
      : m(model),
        springs(on_host(ResolveTargets{face_search(model, state)})),
        passed(on_host(DropPassedTargets{face_search(model, state)})),
        rims(on_host(HoldAtRims{face_search(model, state)})),
        edges(on_host(touching_edges(model, state))),
        hidden(on_host(hidden_edges(model, state))),
        found(on_host(edge_columns(state))),
        movable(on_host(model.face_movable)),
        block(on_host(model.face_block)),
        reach(on_host(model.face_reach)),
        count(Index(state.search.exposed_face.size())),
        overlaps(live_overlaps(model, state)),
        bonded(on_host(overlaps.view())),
        sides(side_boxes(model, state)) {}

  /// Contacts of an exposed face that either search has missed.
  Index count_missed(Index x) const {
    const std::vector<Index> others = faces_near(x);
    const Index missed = count_missed_springs(x, others);
    return m.semi_edges ? missed + count_missed_edges(x, others) : missed;
  }

 private:
  Index face(Index x) const { return springs.exposed_face[x]; }
  bool is_movable(Index x) const { return movable[face(x)] != 0; }
  /// Do spheres around two faces overlap, with room for any depth of contact?
  bool are_near(Index x, Index t) const {
    const Vec3<Real> apart = springs.geometry.center(x) - springs.geometry.center(t);
    const Real* const length = springs.faces.face_length;
    const Real near = reach[face(x)] + reach[face(t)] + length[face(x)] + length[face(t)];
    return dot(apart, apart) < near * near;
  }
  std::vector<Index> faces_near(Index x) const {
    std::vector<Index> others;
    for (Index t = 0; t < count; ++t)
      if (block[face(t)] != block[face(x)] && (is_movable(t) || is_movable(x)) && are_near(x, t) &&
          !bonded.faces(x, t))
        others.push_back(t);
    return others;
  }
  Index count_missed_springs(Index x, const std::vector<Index>& others) const {
    Index missed = 0;
    Flag ignored = 0;
    std::vector<Index> open;
    for (Index k = 0; k < springs.faces.vertex_count(face(x)); ++k) {
      const Index node = springs.faces.vertex(face(x), k);
      open.clear();
      std::copy_if(others.begin(), others.end(), std::back_inserter(open),
                   [&](Index t) { return !bonded.vertices(node, t) && !passed.passes(x, k, t); });
      const FaceList list{open.data(), nullptr, Index(open.size())};
      Index target = springs.choose(x, k, list, &ignored);
      const Index before = springs.springs.target_before[4 * x + k];
      if (target < 0 && before >= 0 && !(rims.action_at_rim(x, k, before) < 0)) target = before;
      missed += springs.springs.target[4 * x + k] != target;
    }
    return missed;
  }
  /// Do side k of exposed face x and side j of t touch?
  bool touch(Index x, Index k, Index t, Index j) const {
    Index shared;
    if (!pair_sides(edges.faces, face(x), k, face(t), j, shared)) return false;
    const Index before = edges.held.place_of(4 * x + k, edges.faces.face_edges[4 * face(t) + j]);
    return edges.touch(4 * x + k, 4 * t + j, shared, before) &&
           (before >= 0 || !hidden.hide(4 * x + k, 4 * t + j));
  }
  /// Has the step found that they do?
  bool is_found(Index x, Index k, Index t, Index j) const {
    for (Index c = found.first[x]; c < found.first[x + 1]; ++c) {
      const EdgeContact contact = EdgeContact::at(found.contact, c);
      if (contact.mother == 4 * x + k && contact.face == t &&
          contact.edge == edges.faces.face_edges[4 * face(t) + j])
        return true;
    }
    return false;
  }
  Index count_missed_edges(Index x, const std::vector<Index>& others) const {
    Index missed = 0, known = 0;  // counts of listed ones
    for (const Index t : others)
      for (Index k = 0; k < edges.faces.vertex_count(face(x)); ++k)
        for (Index j = 0; j < edges.faces.vertex_count(face(t)); ++j)
          if (sides[4 * std::size_t(x) + k].overlaps(sides[4 * std::size_t(t) + j]) &&
              touch(x, k, t, j))
            is_found(x, k, t, j) ? ++known : ++missed;
    return missed + found.first[x + 1] - found.first[x] - known;
  }

  const Model& m;
  const ResolveTargets springs;
  const DropPassedTargets passed;
  const HoldAtRims rims;
  const TouchingEdges edges;
  const HiddenEdges hidden;
  const EdgeColumns found;
  const OnHost<const Flag> movable;
  const OnHost<const Index> block;
  const OnHost<const Real> reach;
  const Index count;  // of exposed faces
  const Bonded overlaps;
  const BondedView bonded;  // of those
  const std::vector<Box> sides;
};

Index count_missed_contacts(const Model& m, State& s) {
  update_all_face_geometry(m, s, {});
  finish({});
  const AllPairs all(m, s);
  const Index count = Index(s.search.exposed_face.size());
  Index missed = 0;
#pragma omp parallel for schedule(dynamic, 8) reduction(+ : missed)
  for (Index x = 0; x < count; ++x) missed += all.count_missed(x);
  return missed;
}

}  // namespace

void check_against_all_pairs(const Model& m, State& s) {
  const PhaseTimer timer(s, Phase::search);
  if (m.check_search) s.missed += count_missed_contacts(m, s);
}

}  // namespace cdem
