// sleep.hpp - what is fixed and stays as it is needs no computing. Host code.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// List the blocks of elements, bonded pairs and nodes that are awake. Asleep are elements and
/// pairs of which all nodes are fixed, and fixed nodes at which nothing awake pulls and that no
/// list of contacts has: what the last step computed for them holds until the model changes.
/// Computing them again would give the same bits. (Faces that a broken bond exposes are no reason
/// to wake: bonds with a free side never sleep.)
void find_awake(const Model& model, State& state);

/// List the awake nodes anew after the lists of contacts: those that were on the last ones stay
/// awake until the next, for they have yet to forget their contacts. Finds the free blocks, too.
void list_awake_nodes(const Model& model, State& state);

}  // namespace cdem
