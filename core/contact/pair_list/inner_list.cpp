// inner_list.cpp - see inner_list.hpp.
#include "core/contact/pair_list/inner_list.hpp"

#include "core/base/primitives.hpp"
#include "core/contact/broad_phase/predicted_motion.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/contact/pair_list/prune.hpp"
#include "core/contact/pair_list/views.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

/// Predict the motion of the nodes from here on.
void predict_inner_motion(const Model& m, State& s, Queue q) {
  InnerList& inner = s.search.inner;
  const Index count = Index(s.search.outer.predicted_nodes.size());
  inner.predicted.renew(8 * std::size_t(count));
  inner.skin.resize(m.node_count);
  for_each_item(q, count,
                PredictInner{.nodes = {s.nodes.motion.data()},
                             .nodes_of = s.search.outer.predicted_nodes.data(),
                             .outer = s.search.outer.predicted.data(),
                             .time = inner_horizon * s.search.outer.lookahead_time,
                             .predicted = inner.predicted.data(),
                             .skin = inner.skin.data()});
  inner.built_time = s.time;
  inner.known = true;
  inner.skin_exceeded = false;
}

ListedFaces listed_faces(const SearchState& search) {
  const Index stride = Index(search.outer.vf_pairs.size() / 2);
  return {.first = search.outer.slot_first.data(),
          .pair = search.outer.slot_pairs.data(),
          .face_of = search.outer.vf_pairs.data() + stride,
          .room = {search.outer.vf_bounds.data(), stride},
          .near = search.inner.faces.data(),
          .motion = {search.inner.motion.data(), stride},
          .rotation = search.outer.rotation_soon.data()};
}

/// Mark the faces that are near a vertex, and find how many they are.
void mark_vertex_faces(const Model& m, State& s, Queue q, Answer<Index>& found) {
  SearchState& search = s.search;
  InnerList& inner = search.inner;
  const Index stride = Index(search.outer.vf_pairs.size() / 2), pairs = stride;
  inner.faces.renew(pairs);
  inner.motion.renew(pairs);
  for_each_lane(q, pairs,
                MarkNearFaces{.nodes = {s.nodes.motion.data()},
                              .geometry = face_geometry(s),
                              .of = {search.outer.vf_pairs.data(), stride},
                              .room = {search.outer.vf_bounds.data(), stride},
                              .rotation = search.outer.rotation_soon.data(),
                              .skin = inner.skin.data(),
                              .near = inner.faces.data(),
                              .motion = inner.motion.data()});
  const Index count = Index(search.exposed_face.size()), slots = 4 * count;
  const ListedFaces listed = listed_faces(search);
  inner.candidates.renew(search.outer.slot_pairs.size());
  set_all(q, Index(inner.candidates.size()), inner.candidates.data(), Flag(0));
  for_each_selected(q, count,
                    MarkInnerFaces{.faces = face_columns(m, s),
                                   .geometry = face_geometry(s),
                                   .rules = m.rules,
                                   .listed = listed,
                                   .close = inner.candidates.data()});
  inner.count.renew(slots);
  for_each_item(q, slots,
                CountInnerFaces{listed.first, inner.candidates.data(), inner.count.data()});
  inner.first.renew(slots + 1);
  add_up(q, slots, inner.count.data(), inner.first.data(), found);
}

void list_vertex_faces(State& s, Queue q, Index found) {
  InnerList& inner = s.search.inner;
  inner.candidate.renew(found);
  inner.rises.renew(found);
  inner.may_begin.renew(found);
  for_each_item(q, 4 * Index(s.search.exposed_face.size()),
                ListInnerFaces{.listed = listed_faces(s.search),
                               .close = inner.candidates.data(),
                               .first = inner.first.data(),
                               .other = inner.candidate.data(),
                               .rises = inner.rises.data()});
}

void prune_edges(const Model& m, State& s, Queue q) {
  SearchState& search = s.search;
  InnerList& inner = search.inner;
  const Index pairs = Index(search.outer.ee_codes.size()), stride = padded_stride(pairs);
  const ListedEdges listed{.of = {search.outer.ee_pairs.data(), stride},
                           .code = search.outer.ee_codes.data(),
                           .sides = search.outer.ee_sides.data(),
                           .table = search.exposed.data()};
  inner.edges.renew(pairs);
  for_each_lane(q, pairs,
                MarkNearEdges{.nodes = {s.nodes.motion.data()},
                              .listed = listed,
                              .room = {search.outer.ee_bounds.data(), stride},
                              .skin = inner.skin.data(),
                              .rules = m.rules,
                              .dt = s.dt_last,
                              .near = inner.edges.data()});
  const PairsOfEdges of_edges{.first = search.outer.edge_first.data(),
                              .listed = search.outer.edge_pairs.data(),
                              .edges = edges_of_pairs(search.outer)};
  if (pairs > 0)
    for_each_item(q, Index(s.edges.contact.size() / 4),
                  MarkHeldEdges{.exposed_face = search.exposed_face.data(),
                                .face_edges = m.face_edges.data(),
                                .contact = s.edges.contact.data(),
                                .pairs = of_edges,
                                .near = inner.edges.data()});
  Column<Flag> joined;
  joined.renew(pairs);
  copy_items(q, pairs, inner.edges.data(), joined.data());
  if (pairs > 0)
    for_each_item(q, pairs, JoinPairsOfEdges{inner.edges.data(), of_edges, joined.data()});
  inner.edges.swap(joined);
  select_items(q, pairs, IsSet{inner.edges.data()}, inner.near_edges);
  const Index count = Index(inner.near_edges.size());
  const Index near_stride = padded_stride(count);
  inner.edge_ends.renew(4 * std::size_t(near_stride));
  inner.edge_sides.renew(4 * std::size_t(near_stride));
  inner.edge_codes.renew(near_stride);
  inner.edge_of.renew(2 * std::size_t(near_stride));
  inner.open.renew(count);
  inner.held.renew(4 * std::size_t(near_stride));
  inner.held_known = false;
  for_each_item(q, count,
                CopyInnerEdges{.near = inner.near_edges.data(),
                               .listed = listed,
                               .edge_of = search.outer.ee_edges.data(),
                               .ends = inner.edge_ends.data(),
                               .sides = inner.edge_sides.data(),
                               .codes = inner.edge_codes.data(),
                               .edges = inner.edge_of.data(),
                               .stride = near_stride});
}

}  // namespace

void prune_pair_list(const Model& m, State& s, Queue q) {
  Answer<Index> faces;  // read after the edges are found, so that both have one wait
  predict_inner_motion(m, s, q);
  mark_vertex_faces(m, s, q, faces);
  if (m.semi_edges) prune_edges(m, s, q);
  list_vertex_faces(s, q, faces.read(q));
}

void prune_pair_list_if_due(const Model& m, State& s, Queue q) {
  const PhaseTimer timer(s, Phase::search);
  const InnerList& inner = s.search.inner;
  if (!inner.known || inner.skin_exceeded) prune_pair_list(m, s, q);
}

}  // namespace cdem
