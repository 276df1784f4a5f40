// narrow_phase.cpp - see narrow_phase.hpp.
#include "core/contact/narrow_phase/narrow_phase.hpp"

#include "core/base/parallel.hpp"
#include "core/contact/narrow_phase/edge_contacts.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

void find_target_faces(const Model& m, State& s, Queue q) {
  const PhaseTimer timer(s, Phase::search);
  const Index count = Index(s.search.exposed_face.size());
  s.springs.unresolved.resize(s.springs.target.size());
  const FaceSearch search = face_search(m, s);
  for_each_item(q, count, BeginTargets{search.springs});
  for_each_selected(q, count, UpdateHeldTargets{search});
  for_each_selected(q, count, FilterNewTargets{search});
  for_each_item(q, count, ResolveTargets{search});
}

void find_target_edges(const Model& m, State& s, Queue q) {
  if (!m.semi_edges) return;
  const PhaseTimer timer(s, Phase::search);
  begin_edges(s);
  InnerList& inner = s.search.inner;
  const Index pairs = Index(inner.near_edges.size());
  for_each_selected(q, pairs, FindHeldEdges{edge_pairs(s), edges_before(s), inner.held_known});
  for_each_lane(q, pairs,
                FilterEdgePairs{.nodes = {s.nodes.motion.data()},
                                .geometry = face_geometry(s),
                                .pairs = edge_pairs(s),
                                .rules = m.rules});
  do {
    for_each_selected(q, pairs, edge_search(m, s));
    finish(q);
  } while (!make_room_for_edges(s));
  for_each_item(q, pairs, ForgetHeldEdges{edge_pairs(s)});
  inner.held_known = true;
  for_each_item(q, Index(s.search.exposed_face.size()),
                ListEdgeContacts{.touch = edge_search(m, s),
                                 .interfaces = face_interfaces(m),
                                 .first = s.edges.first.data(),
                                 .contact = s.edges.contact.data(),
                                 .friction = s.edges.friction.data(),
                                 .dashpot = s.edges.dashpot.data()});
}

}  // namespace cdem
