// transfer_to_contact.cpp - see transfer_to_contact.hpp.
#include "core/bonds/transfer_to_contact.hpp"

#include "core/base/primitives.hpp"
#include "core/bonds/conforming_transfer.hpp"
#include "core/bonds/give_history.hpp"
#include "core/bonds/overlap_transfer.hpp"
#include "core/bonds/release_pairs.hpp"
#include "core/bonds/views.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/narrow_phase/edge_contacts.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

PairSides sides_of(const PairSet& p, const State& s, const Column<Index>& pairs) {
  return {pairs.data(), p.faces.data(), s.search.face_exposed.data()};
}

/// Sides of pairs by exposed face.
struct SidesByFace {
  Column<Index> first, rows;

  SidesByFace(const State& s, const PairSides& sides, Index pairs) {
    const Index faces = Index(s.search.exposed_face.size());
    list_rows_in_room({}, 2 * pairs, 2 * pairs, faces, sides, first, rows);
  }
};

PointsOnFaces points_on_faces(const Model& m, const PairSet& p) {
  return {.face_nodes = m.face_nodes.data(),
          .nodes = {p.nodes.data(), p.stride},
          .points = p.points,
          .stride = p.point_stride,
          .point_first = conforms(p) ? nullptr : p.point_first.data(),
          .weights = {p.weights_a.data(), p.weights_b.data()},
          .point_area = p.point_area.data()};
}

BondEnds bond_ends(const Model& m, State& s, const PairSet& p, PairState& ps) {
  return {
      .pairs = pair_columns(m, p, ps), .corner_force = corner_forces(s, p), .corners = p.corners};
}

TransferToContacts conforming_transfer(const Model& m, State& s, const PairSet& p, PairState& ps,
                                       const Column<Index>& released) {
  return {.released = released.data(),
          .faces = face_columns(m, s),
          .rules = m.rules,
          .lengths = pair_lengths(m, p),
          .nodes = {p.nodes.data(), p.stride},
          .points = p.points,
          .bonds = pair_columns(m, p, ps),
          .face_stiffness = m.face_stiffness.data(),
          .target = s.springs.target.data(),
          .target_before = s.springs.target_before.data(),
          .springs = s.springs.state.data()};
}

}  // namespace

void give_history(const Model& m, State& s, const PairSet& p, const PairState& ps,
                  const Column<Index>& pairs) {
  const Index count = Index(pairs.size());
  if (count == 0 || s.springs.history.width == 0) return;
  const PairSides sides = sides_of(p, s, pairs);
  const SidesByFace by_face(s, sides, count);
  for_each_item({}, Index(s.search.exposed_face.size()),
                GiveHistory{.sides = sides,
                            .first = by_face.first.data(),
                            .rows = by_face.rows.data(),
                            .points = points_on_faces(m, p),
                            .interface = p.interface.data(),
                            .interfaces = m.interfaces.data(),
                            .remembered = ps.history.data(),
                            .vertices = history_rows(s.springs.history),
                            .edges = history_rows(s.edges.side_history)});
}

void transfer_to_contact(const Model& m, State& s, const PairSet& p, PairState& ps,
                         const Column<Index>& released) {
  const Index count = Index(released.size());
  if (count == 0) return;
  give_history(m, s, p, ps, released);
  if (conforms(p))
    for_each_item({}, count, conforming_transfer(m, s, p, ps, released));
  else
    list_items({}, count, ListBonded{released.data(), ps.status.data()}, s.released_overlaps);
  for_each_item({}, count,
                ReleasePairs{.released = released.data(),
                             .ends = bond_ends(m, s, p, ps),
                             .status = ps.status.data(),
                             .wait = !conforms(p)});
}

void await_contacts(const Model& m, State& s) {
  const Index released = Index(s.released_overlaps.size());
  if (released == 0) return;
  Column<Index> pairs;
  list_items({}, released, ListLifted{s.released_overlaps.data(), overlap_bonds(m, s)}, pairs);
  const Index count = Index(pairs.size());
  if (count == 0) return;
  const PairSides sides = sides_of(m.overlaps, s, pairs);
  const SidesByFace by_face(s, sides, count);
  for_each_item({}, Index(s.search.exposed_face.size()),
                AwaitSprings{.sides = sides,
                             .first = by_face.first.data(),
                             .rows = by_face.rows.data(),
                             .faces = face_columns(m, s),
                             .rules = m.rules,
                             .target = s.springs.target.data(),
                             .target_before = s.springs.target_before.data(),
                             .states = s.springs.state.data()});
  if (!m.semi_edges) return;
  Column<EdgeContact> contacts;
  list_items({}, 2 * count, ListAwaitedEdges{sides, face_columns(m, s)}, contacts);
  add_edges(s, contacts, awaited_state(m.rules));
}

void transfer_released_bonds(const Model& m, State& s, Queue q) {
  const PhaseTimer timer(s, Phase::search);
  const Index count = Index(s.released_overlaps.size());
  if (count == 0) return;
  const Index* const released = s.released_overlaps.data();
  Successors contacts{.bonds = overlap_bonds(m, s),
                      .rules = m.rules,
                      .geometry = face_geometry(s),
                      .laws = contact_laws(m, s),
                      .exposed_face = s.search.exposed_face.data(),
                      .target = s.springs.target.data(),
                      .target_before = s.springs.target_before.data(),
                      .springs = s.springs.state.data(),
                      .edge_first = s.edges.first.data(),
                      .edges = s.edges.contact.data(),
                      .edge_states = s.edges.old_state.data()};
  Column<Index> first;
  first.renew(std::size_t(count) + 1);
  for_each_item(q, count, CountNewStates{released, contacts, first.data() + 1});
  const Index known = Index(s.edges.old_state.size() / 8);
  const Index more = scan(q, count, first.data() + 1, first.data());
  if (more > 0) {
    Column<Real> states;
    states.renew(8 * (std::size_t(known) + more));
    copy_items(q, 8 * known, s.edges.old_state.data(), states.data());
    s.edges.old_state.swap(states);
    contacts.edge_states = s.edges.old_state.data();
  }
  for_each_item(q, count,
                GiveToSuccessors{.released = released,
                                 .contacts = contacts,
                                 .ends = bond_ends(m, s, m.overlaps, s.overlaps),
                                 .first = first.data(),
                                 .known = known});
  s.released_overlaps.renew(0);
}

}  // namespace cdem
