// candidates.hpp - which faces and edges may touch before the lists are renewed. Host code.
#pragma once

#include "core/model.hpp"
#include "core/state.hpp"

namespace cdem {

/// Face -> faces that it may touch; pair of faces -> pairs of their sides that may cross.
void list_candidates(const Model& model, State& state);

/// Node -> contact rows of its exposed faces, and the motion at which each node's list is old.
void list_contact_corners(const Model& model, State& state);

}  // namespace cdem
