// candidates.hpp - the lists of what may touch before they are renewed. Host code.
#pragma once

#include "core/model.hpp"
#include "core/state.hpp"

namespace cdem {

/// Vertex -> faces that it may touch; face -> sides of others that its own may cross.
void list_candidates(const Model& model, State& state);

/// Node -> rows of its elements and of its pairs that are not released.
void list_corners(const Model& model, State& state);

/// Node -> contact rows of its exposed faces that are not idle.
void list_contact_corners(const Model& model, State& state);

}  // namespace cdem
