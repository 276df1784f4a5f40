// inner_list.cpp - see inner_list.hpp.
#include "core/contact/pair_list/inner_list.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"
#include "core/contact/broad_phase/predicted_motion.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/contact/pair_list/prune.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

bool close_lists_are_old(const State& s) {
  const CloseState& close = s.search.close;
  return !close.known ||
         any_strayed(s, close.watch, close.built_time, close_way * s.search.horizon);
}

/// From here on the nodes are watched. They may stray as far as they would with the velocity that
/// they have now, beyond the foreseen one, and a little more; what is hit strays farther and calls
/// for new lists.
void watch_nodes(const Model& m, State& s) {
  constexpr Real more = 1.5, least = 0.05;
  CloseState& close = s.search.close;
  const InMotion nodes{s.nodes.motion.data()};
  const Index count = Index(s.search.watched.size());
  const Real way = more * close_way * s.search.horizon;
  close.watch.resize(8 * std::size_t(count));
  close.skin.resize(m.node_count);
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index w = 0; w < count; ++w) {
    const Index node = s.search.watched[w];
    const WatchedNode foreseen = WatchedNode::of(s, node);
    const Real stray = way * norm(nodes.velocity(node) - foreseen.velocity);
    const Real skin = std::clamp(stray, least * foreseen.skin, close_skin * foreseen.skin);
    close.skin[node] = skin;
    WatchedNode{nodes.position(node), foreseen.velocity, skin}.store(close.watch.data() +
                                                                     8 * std::size_t(w));
  }
  close.built_time = s.time;
  close.known = true;
}

void list_close_faces(const Model& m, State& s, Queue q) {
  SearchState& search = s.search;
  CloseState& close = search.close;
  const Index stride = Index(search.faces_of.size() / 2), pairs = stride;
  close.faces.resize(pairs);
  close.motion.resize(pairs);
  for_each_lane(q, pairs,
                MarkNearFaces{{s.nodes.motion.data()},
                              face_geometry(s),
                              {search.faces_of.data(), stride},
                              {search.faces_bounds.data(), stride},
                              search.turn_soon.data(),
                              close.skin.data(),
                              close.faces.data(),
                              close.motion.data()});
  const Index count = Index(search.exposed_face.size()), slots = 4 * count;
  const ListedFaces listed{search.candidate_first.data(), search.candidate.data(),
                           search.candidate_pair.data(),  close.faces.data(),
                           close.motion.data(),           search.turn_soon.data()};
  close.candidates.resize(search.candidate.size());
  for_each_selected(q, count,
                    MarkCloseFaces{face_columns(m, s), face_geometry(s), m.rules, listed,
                                   close.candidates.data()});
  close.count.resize(slots);
  for_each_item(q, slots,
                CountCloseFaces{listed.first, close.candidates.data(), close.count.data()});
  finish(q);
  close.first.resize(slots + 1);
  for (Index i = 0; i < slots; ++i) close.first[i + 1] = close.first[i] + close.count[i];
  close.candidate.resize(close.first[slots]);
  close.may_begin.resize(close.first[slots]);
  for_each_item(
      q, slots,
      ListCloseFaces{listed, close.candidates.data(), close.first.data(), close.candidate.data()});
}

/// Where faces of two elements meet at an edge, the pair that finds it may be another one than that
/// of which it was near: all pairs of the same two edges go together.
void join_pairs_of_edges(const Model& m, SearchState& search) {
  CloseState& close = search.close;
  const Index pairs = Index(search.edges_code.size()), stride = padded_stride(pairs);
  const InIndices of{search.edges_of.data(), stride};
  const auto is_of_one = [&](Index p, Index which) {
    return search.edge_sides[2 * std::size_t(of.at(which, One{p})) + 1] >= 0;
  };
  const auto edge_of = [&](Index p, Index which) {
    const Index side = search.edge_sides[2 * std::size_t(of.at(which, One{p}))];
    return m.face_edges[4 * search.exposed_face[side / 4] + side % 4];
  };
  for (Index p = 0; p < pairs; ++p) {
    if (!close.edges[p] || (is_of_one(p, 0) && is_of_one(p, 1))) continue;
    const Index edge = edge_of(p, 0), other = edge_of(p, 1);
    for (Index i = search.edge_pairs_first[edge]; i < search.edge_pairs_first[edge + 1]; ++i)
      if (search.edge_pairs[2 * i + 1] == other) close.edges[search.edge_pairs[2 * i]] = 1;
  }
}

void list_close_edges(const Model& m, State& s, Queue q) {
  SearchState& search = s.search;
  CloseState& close = search.close;
  const Index pairs = Index(search.edges_code.size()), stride = padded_stride(pairs);
  const ListedEdges listed{{search.edges_of.data(), stride},
                           search.edges_code.data(),
                           search.edge_sides.data(),
                           search.exposed.data()};
  close.edges.resize(pairs);
  for_each_lane(q, pairs,
                MarkNearEdges{{s.nodes.motion.data()},
                              listed,
                              {search.edges_bounds.data(), stride},
                              close.skin.data(),
                              m.rules,
                              s.dt_last,
                              close.edges.data()});
  if (pairs > 0)
    for_each_item(q, Index(s.edges.contact.size() / 4),
                  MarkHeldEdges{search.exposed_face.data(), m.face_edges.data(),
                                s.edges.contact.data(), search.edge_pairs_first.data(),
                                search.edge_pairs.data(), close.edges.data()});
  finish(q);
  join_pairs_of_edges(m, search);
  close.near_edges.resize(pairs);
  Index count = 0;
  for (Index p = 0; p < pairs; ++p) {
    close.near_edges[count] = p;
    count += close.edges[p];
  }
  close.near_edges.resize(count);
  const Index near_stride = padded_stride(count);
  close.edge_pairs.resize(9 * std::size_t(near_stride));
  close.open.resize(count);
  for_each_item(
      q, count,
      CopyCloseEdges{close.near_edges.data(), listed, close.edge_pairs.data(), near_stride});
}

}  // namespace

void list_close(const Model& m, State& s, Queue q) {
  watch_nodes(m, s);
  list_close_faces(m, s, q);
  if (m.semi_edges) list_close_edges(m, s, q);
  finish(q);
}

void prune_pair_list_if_due(const Model& m, State& s, Queue q) {
  const PhaseTimer timer(s, Phase::search);
  if (close_lists_are_old(s)) list_close(m, s, q);
}

}  // namespace cdem
