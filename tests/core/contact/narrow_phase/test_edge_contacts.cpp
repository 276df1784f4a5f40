// The list of semi-edge contacts, which every step makes again.
#include "core/contact/narrow_phase/edge_contacts.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// Three exposed faces; two contacts of the second.
void fill(State& s) {
  s.search.exposed_face.resize(3);
  const Index first[] = {0, 0, 2, 2};
  s.edges.first.assign(first, 4);
  s.edges.contact.resize(8);
  s.edges.state.resize(16);
  EdgeContact{5, 0, 7, -1}.store(s.edges.contact.data(), 1);
}

}  // namespace

TEST_CASE("the list of a step begins empty; the last one is kept for its history") {
  State s;
  fill(s);
  begin_edges(s);
  CHECK(on_host(s.edges.old_first)[2] == 2);
  CHECK(EdgeContact::at(s.edges.old_contact.data(), 1).edge == 7);
  CHECK(s.edges.old_state.size() == 16);
}

TEST_CASE("there is room for as many contacts as were found") {
  State s;
  fill(s);
  begin_edges(s);
  s.edges.found.resize(5);
  make_room_for_edges(s);
  CHECK(s.edges.contact.size() == 4 * 5);
  CHECK(s.edges.state.size() == 8 * 5);
  CHECK(s.edges.reaction.size() == 8 * 5);
  CHECK(s.edges.seen.size() == 5);
}

TEST_CASE("contacts are added to their faces in the state given; those there stay as they are") {
  State s;
  fill(s);
  ContactState held{};
  held.force_n = 3;
  held.store(s.edges.state.data(), 1);
  s.edges.reaction.resize(16);
  ContactState awaited = ContactState::none();
  awaited.stress_free_gap = 1e-3;
  s.search.inner.held_known = true;
  Column<EdgeContact> contacts;
  contacts.assign({{9, 0, 4, -1}, {5, 0, 7, -1}, {2, 1, 4, -1}, {9, 0, 4, -1}});
  add_edges(s, contacts, awaited);
  const Index first[] = {0, 1, 3, 4};
  for (Index x = 0; x < 4; ++x) CHECK(on_host(s.edges.first)[x] == first[x]);
  CHECK(EdgeContact::at(s.edges.contact.data(), 0).mother == 2);
  CHECK(EdgeContact::at(s.edges.contact.data(), 3).mother == 9);
  CHECK(ContactState::at(s.edges.state.data(), 2).force_n == 3);
  CHECK(ContactState::at(s.edges.state.data(), 3).stress_free_gap == 1e-3);
  CHECK(s.edges.reaction.size() == 8 * 4);
  CHECK(!s.search.inner.held_known);
}

}  // namespace cdem::test
