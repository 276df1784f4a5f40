// edge_contacts.cpp - see edge_contacts.hpp.
#include "core/contact/narrow_phase/edge_contacts.hpp"

#include <algorithm>

namespace cdem {

namespace {

void swap_with_old(EdgeState& e) {
  e.first.swap(e.old_first);
  e.contact.swap(e.old_contact);
  e.state.swap(e.old_state);
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

void add_edges(State& s, const std::vector<EdgeContact>& contacts, const ContactState& as) {
  if (contacts.empty()) return;
  s.search.inner.held_known = false;
  const std::size_t count = s.search.exposed_face.size();
  EdgeState& e = s.edges;
  const auto first_before = on_host(e.first), contact_before = on_host(e.contact);
  const auto state_before = on_host(e.state), reaction_before = on_host(e.reaction);
  std::vector<EdgeContact> list;
  std::vector<ContactState> state;
  std::vector<Real> reaction;
  std::vector<Index> first{0};
  for (std::size_t x = 0; x < count; ++x) {
    for (Index c = first_before[x]; c < first_before[x + 1]; ++c) {
      list.push_back(EdgeContact::at(contact_before.data(), c));
      state.push_back(ContactState::at(state_before.data(), c));
      for (Index k = 0; k < 8; ++k) reaction.push_back(reaction_before[8 * std::size_t(c) + k]);
    }
    for (const EdgeContact& one : contacts) {
      if (one.mother / 4 != Index(x)) continue;
      const bool has = std::any_of(list.begin() + first[x], list.end(), [&](const EdgeContact& c) {
        return c.mother == one.mother && c.edge == one.edge;
      });
      if (has) continue;
      list.push_back(one);
      state.push_back(as);
      reaction.resize(reaction.size() + 8);
    }
    first.push_back(Index(list.size()));
  }
  e.first.assign(first);
  e.reaction.assign(reaction);
  e.contact.renew(4 * list.size());
  e.state.renew(8 * list.size());
  const auto contact_now = on_host(e.contact);
  const auto state_now = on_host(e.state);
  for (std::size_t c = 0; c < list.size(); ++c) {
    list[c].store(contact_now.data(), c);
    state[c].store(state_now.data(), c);
  }
}

void sort_edges(State& s, const std::vector<Index>& from, const std::vector<Index>& to) {
  begin_edges(s);
  s.search.inner.held_known = false;
  EdgeState& e = s.edges;
  const std::vector<Real> reaction_before = fetch(e.reaction);
  e.contact.renew(e.old_contact.size());
  e.state.renew(e.old_state.size());
  const auto first_before = on_host(e.old_first), contact_before = on_host(e.old_contact);
  const auto contact = on_host(e.contact);
  const auto state_before = on_host(e.old_state), state = on_host(e.state);
  const auto reaction = on_host(e.reaction);
  std::vector<Index> first(from.size() + 1);
  Index next = 0;
  for (std::size_t x = 0; x < from.size(); ++x) {
    first[x] = next;
    for (Index c = first_before[from[x]]; c < first_before[from[x] + 1]; ++c) {
      const EdgeContact old = EdgeContact::at(contact_before.data(), c);
      if (to[old.face] < 0) continue;
      EdgeContact{.mother = 4 * Index(x) + old.mother % 4,
                  .face = to[old.face],
                  .edge = old.edge,
                  .before = old.before}
          .store(contact.data(), next);
      ContactState::at(state_before.data(), c).store(state.data(), next);
      std::copy_n(reaction_before.begin() + 8 * std::size_t(c), 8,
                  reaction.begin() + 8 * std::size_t(next++));
    }
  }
  first[from.size()] = next;
  e.first.assign(first);
  e.contact.resize(4 * std::size_t(next));
  e.state.resize(8 * std::size_t(next));
  e.reaction.resize(8 * std::size_t(next));
}

}  // namespace cdem
