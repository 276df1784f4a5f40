// edge_contacts.cpp - see edge_contacts.hpp.
#include "core/contact/narrow_phase/edge_contacts.hpp"

#include "core/base/primitives.hpp"
#include "core/contact/narrow_phase/edge_rows.hpp"

namespace cdem {

namespace {

void swap_with_old(EdgeState& e) {
  e.first.swap(e.old_first);
  e.contact.swap(e.old_contact);
  e.state.swap(e.old_state);
}

EdgeRowsBefore rows_of(const EdgeState& e) {
  return {.first = e.first.data(),
          .contact = e.contact.data(),
          .state = e.state.data(),
          .reaction = e.reaction.data()};
}

}  // namespace

void begin_edges(State& s) { swap_with_old(s.edges); }

void make_room_for_edges(State& s) {
  EdgeState& e = s.edges;
  const std::size_t contacts = e.found.size();
  e.contact.renew(4 * contacts);
  e.state.renew(8 * contacts);
  e.reaction.renew(8 * contacts);
  e.seen.renew(contacts);
}

void add_edges(State& s, const Column<EdgeContact>& contacts, const ContactState& as) {
  const Index added = Index(contacts.size());
  if (added == 0) return;
  s.search.inner.held_known = false;
  EdgeState& e = s.edges;
  const Index count = Index(e.first.size()) - 1;
  Column<Index> added_first, list, first, contact;
  Column<Real> state, reaction;
  list_rows_in_room({}, added, added, count, MotherOfEdge{contacts.data()}, added_first, list);
  const AddedEdges all{.rows = rows_of(e),
                       .contact = contacts.data(),
                       .first = added_first.data(),
                       .added = list.data()};
  first.renew(std::size_t(count) + 1);
  for_each_item({}, count, CountAddedEdges{all, first.data() + 1});
  const std::size_t sum = scan({}, count, first.data() + 1, first.data());
  contact.renew(4 * sum);
  state.renew(8 * sum);
  reaction.renew(8 * sum);
  for_each_item({}, count,
                PutAddedEdges{.added = all,
                              .begin = as,
                              .first = first.data(),
                              .rows = {contact.data(), state.data(), reaction.data()}});
  e.first.swap(first);
  e.contact.swap(contact);
  e.state.swap(state);
  e.reaction.swap(reaction);
}

void move_edges(State& s, const Column<Index>& before, const Column<Index>& to) {
  EdgeState& e = s.edges;
  begin_edges(s);
  s.search.inner.held_known = false;
  Column<Real> reaction_before;
  reaction_before.swap(e.reaction);
  const Index count = Index(before.size());
  const KeptEdges kept{.rows = {.first = e.old_first.data(),
                                .contact = e.old_contact.data(),
                                .state = e.old_state.data(),
                                .reaction = reaction_before.data()},
                       .before = before.data(),
                       .to = to.data()};
  e.first.renew(std::size_t(count) + 1);
  Index* const first = e.first.data();
  for_each_item({}, count, CountKeptEdges{kept, first + 1});
  const std::size_t sum = scan({}, count, first + 1, first);
  e.contact.renew(4 * sum);
  e.state.renew(8 * sum);
  e.reaction.renew(8 * sum);
  for_each_item({}, count,
                MoveKeptEdges{.kept = kept,
                              .first = first,
                              .rows = {e.contact.data(), e.state.data(), e.reaction.data()}});
}

}  // namespace cdem
