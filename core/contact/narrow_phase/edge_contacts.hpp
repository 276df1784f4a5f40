// edge_contacts.hpp - the list of the contacts of semi-edges, made in every step.
#pragma once

#include "core/model/state.hpp"

namespace cdem {

/// Before a step's search: the list becomes the old list.
void begin_edges(State& state);

/// After it: room for the contacts found.
void make_room_for_edges(State& state);

/// Add contacts to the list in this state; contacts already listed are unchanged.
void add_edges(State& state, const Column<EdgeContact>& contacts, const ContactState& as);

/// Bring the list to the new places of exposed faces, see PairPlaces. Contacts with faces that have
/// left end.
void move_edges(State& state, const Column<Index>& before, const Column<Index>& to);

}  // namespace cdem
