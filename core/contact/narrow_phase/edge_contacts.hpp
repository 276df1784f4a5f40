// edge_contacts.hpp - the list of the contacts of semi-edges, made in every step. Host code.
#pragma once

#include <vector>

#include "core/model/state.hpp"

namespace cdem {

/// Before a step's search: the list becomes the old list.
void begin_edges(State& state);

/// After it: room for the contacts found.
void make_room_for_edges(State& state);

/// Add contacts to the list in this state; contacts already listed are unchanged.
void add_edges(State& state, const std::vector<EdgeContact>& contacts, const ContactState& as);

/// Bring the list into a new order of the exposed faces: place x was from[x], y becomes to[y];
/// where that is -1 the contacts end.
void sort_edges(State& state, const std::vector<Index>& from, const std::vector<Index>& to);

}  // namespace cdem
