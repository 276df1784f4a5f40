// views.hpp - what the kernels of the narrow phase see of model and state.
#pragma once

#include "core/contact/geometry/views.hpp"
#include "core/contact/narrow_phase/target_edge.hpp"
#include "core/contact/narrow_phase/target_face.hpp"

namespace cdem {

inline Candidates candidate_columns(State& s) {
  InnerList& inner = s.search.inner;
  return {inner.first.data(), inner.candidate.data(), inner.may_begin.data()};
}

inline EdgePairs edge_pairs(State& s) {
  InnerList& inner = s.search.inner;
  const Index stride = padded_stride(Index(inner.near_edges.size()));
  return {.ends = {inner.edge_ends.data(), stride},
          .sides = {inner.edge_sides.data(), stride},
          .code = {inner.edge_codes.data(), stride},
          .open = inner.open.data()};
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

inline ResolveTargetEdges edge_search(const Model& m, State& s) {
  return {face_columns(m, s),  face_geometry(s), s.search.exposed_face.data(),
          edge_pairs(s),       m.rules,          edges_before(s),
          s.edges.lost.data(), found_edges(s)};
}

}  // namespace cdem
