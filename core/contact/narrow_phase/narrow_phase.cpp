// narrow_phase.cpp - see narrow_phase.hpp.
#include "core/contact/narrow_phase/narrow_phase.hpp"

#include "core/base/primitives.hpp"
#include "core/contact/narrow_phase/edge_contacts.hpp"
#include "core/contact/narrow_phase/soft_rim.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

void find_target_faces(const Model& m, State& s, Queue q) {
  const PhaseTimer timer(s, Phase::search);
  const Index count = Index(s.search.exposed_face.size());
  s.springs.unresolved.renew(s.springs.target.size());
  const FaceSearch search = face_search(m, s);
  for_each_item(q, count, BeginTargets{search.springs});
  for_each_selected(q, count, UpdateHeldTargets{search});
  for_each_selected(q, count, FilterNewTargets{search});
  for_each_item(q, count, DropPassedTargets{search});
  for_each_item(q, count, ResolveTargets{search});
  for_each_item(q, count, HoldAtRims{search});
}

namespace {

/// Every pair of edges learns the places of its contacts of one step ago.
void recall_held_edges(State& s, Queue q) {
  InnerList& inner = s.search.inner;
  const EdgePairs pairs = edge_pairs(s);
  if (inner.held_known) {
    set_all(q, Index(inner.held.size()), inner.held.data(), Index(-1));
    for_each_item(q, Index(s.edges.seen.size()),
                  RecallHeldEdges{s.edges.seen.data(), inner.held.data()});
  }
  for_each_selected(q, Index(inner.near_edges.size()),
                    FindHeldEdges{pairs, edges_before(s), inner.held_known});
  inner.held_known = true;
}

}  // namespace

void find_target_edges(const Model& m, State& s, Queue q) {
  if (!m.semi_edges) return;
  const PhaseTimer timer(s, Phase::search);
  begin_edges(s);
  recall_held_edges(s, q);
  const Index count = Index(s.search.exposed_face.size());
  const EdgePairs pairs = edge_pairs(s);
  const Index pair_count = Index(s.search.inner.near_edges.size());
  for_each_lane(q, pair_count,
                FilterEdgePairs{.nodes = {s.nodes.motion.data()},
                                .geometry = face_geometry(s),
                                .pairs = pairs,
                                .rules = m.rules});
  for_each_selected(q, pair_count, edge_search(m, s));
  for_each_item(q, pair_count, DropHiddenEdges{hidden_edges(m, s), pairs});
  list_rows(q, pair_count, EdgeWays::count * pair_count, count, FoundEdges{pairs}, s.edges.first,
            s.edges.found);
  make_room_for_edges(s);
  for_each_item(q, count,
                ListEdgeContacts{.search = edge_search(m, s),
                                 .interfaces = face_interfaces(m),
                                 .first = s.edges.first.data(),
                                 .found = s.edges.found.data(),
                                 .contact = s.edges.contact.data(),
                                 .seen = s.edges.seen.data(),
                                 .friction = s.edges.friction.data(),
                                 .dashpot = s.edges.dashpot.data()});
}

}  // namespace cdem
