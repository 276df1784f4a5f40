// views.hpp - what the kernels of the narrow phase see of model and state.
#pragma once

#include "core/contact/geometry/views.hpp"
#include "core/contact/narrow_phase/target_edge.hpp"
#include "core/contact/narrow_phase/target_face.hpp"

namespace cdem {

inline Candidates candidate_columns(State& s) {
  CloseState& close = s.search.close;
  return {close.first.data(), close.candidate.data(), close.may_begin.data()};
}

inline EdgePairs edge_pairs(State& s) {
  CloseState& close = s.search.close;
  const Index count = Index(close.near_edges.size()), stride = padded_stride(count);
  const Index* rows = close.edge_pairs.data();
  return {{rows, stride},
          {rows + 4 * std::size_t(stride), stride},
          {rows + 8 * std::size_t(stride), stride},
          close.open.data()};
}

inline SpringColumns spring_columns(State& s) {
  SpringState& c = s.springs;
  return {c.target.data(),  c.target_before.data(), c.state.data(), c.friction.data(),
          c.dashpot.data(), c.reaction.data(),      c.lost.data()};
}

inline EdgeColumns edge_columns(State& s) {
  EdgeState& c = s.edges;
  return {c.first.data(), c.contact.data(), c.state.data(), c.reaction.data()};
}

inline EdgesBefore edges_before(const State& s) {
  const EdgeState& c = s.edges;
  return {c.old_first.data(), c.old_contact.data(), c.old_state.data()};
}

inline FaceSearch face_search(const Model& m, State& s) {
  return {face_columns(m, s),   face_geometry(s), s.search.exposed_face.data(),
          candidate_columns(s), m.rules,          spring_columns(s)};
}

inline FoundEdges found_edges(State& s) {
  return {s.edges.slots, s.edges.found_count.data(), s.edges.found.data(), runs_alone()};
}

inline TouchTargetEdges edge_search(const Model& m, State& s) {
  return {face_columns(m, s),  face_geometry(s), s.search.exposed_face.data(),
          edge_pairs(s),       m.rules,          edges_before(s),
          s.edges.lost.data(), found_edges(s)};
}

}  // namespace cdem
