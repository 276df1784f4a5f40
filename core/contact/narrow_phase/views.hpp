// views.hpp - the view of model and state for kernels of the narrow phase.
#pragma once

#include "core/contact/geometry/views.hpp"
#include "core/contact/narrow_phase/target_edge.hpp"
#include "core/contact/narrow_phase/target_face.hpp"

namespace cdem {

inline Candidates candidate_columns(State& s) {
  InnerList& inner = s.search.inner;
  return {.first = inner.first.data(),
          .other = inner.candidate.data(),
          .rises = inner.rises.data(),
          .may_begin = inner.may_begin.data()};
}

inline EdgePairs edge_pairs(State& s) {
  InnerList& inner = s.search.inner;
  const Index stride = padded_stride(Index(inner.near_edges.size()));
  return {.ends = {inner.edge_ends.data(), stride},
          .sides = {inner.edge_sides.data(), stride},
          .code = {inner.edge_codes.data(), stride},
          .edges = {inner.edge_of.data(), stride},
          .open = inner.open.data(),
          .held = inner.held.data(),
          .stride = stride};
}

inline SpringColumns spring_columns(State& s) {
  SpringState& c = s.springs;
  return {.target = c.target.data(),
          .target_before = c.target_before.data(),
          .state = c.state.data(),
          .friction = c.friction.data(),
          .dashpot = c.dashpot.data(),
          .reaction = c.reaction.data(),
          .rim_action = c.rim_action.data(),
          .lost = c.lost.data(),
          .unresolved = c.unresolved.data()};
}

inline EdgeColumns edge_columns(State& s) {
  EdgeState& c = s.edges;
  return {.first = c.first.data(),
          .contact = c.contact.data(),
          .state = c.state.data(),
          .reaction = c.reaction.data()};
}

inline EdgesBefore edges_before(const State& s) {
  const EdgeState& c = s.edges;
  return {
      .first = c.old_first.data(), .contact = c.old_contact.data(), .state = c.old_state.data()};
}

inline FlushFaces flush_faces(const Model& m) {
  const Index* first = m.flush_face.size() > 0 ? m.flush_first.data() : nullptr;
  return {.first = first,
          .mate = m.flush_face.data(),
          .edge_faces = m.edge_faces.data(),
          .at_node = m.node_flush.data()};
}

inline FaceSearch face_search(const Model& m, State& s) {
  return {.faces = face_columns(m, s),
          .geometry = face_geometry(s),
          .exposed_face = s.search.exposed_face.data(),
          .candidates = candidate_columns(s),
          .rules = m.rules,
          .springs = spring_columns(s),
          .flush = flush_faces(m)};
}

inline TouchingEdges touching_edges(const Model& m, const State& s) {
  return {.faces = face_columns(m, s),
          .geometry = face_geometry(s),
          .rules = m.rules,
          .held = edges_before(s)};
}

inline HiddenEdges hidden_edges(const Model& m, const State& s) {
  return {.faces = face_columns(m, s),
          .geometry = face_geometry(s),
          .rules = m.rules,
          .flush = flush_faces(m),
          .exposed_face = s.search.exposed_face.data()};
}

inline ResolveTargetEdges edge_search(const Model& m, State& s) {
  return {.touching = touching_edges(m, s), .pairs = edge_pairs(s), .lost = s.edges.lost.data()};
}

}  // namespace cdem
