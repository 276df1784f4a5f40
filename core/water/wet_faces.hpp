// wet_faces.hpp - which water presses on the vertices of faces.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Find for each vertex of wet faces the field that presses on it.
///
/// Where bonds of the face hold, water of the joint presses if it does so while they hold, else
/// none. Where none holds it presses on vertices that are in contact, or no farther than the
/// aperture from a face that theirs lay on at the start. On all others water in the open presses,
/// if there is any.
void find_wet_faces(const Model& model, State& state);

}  // namespace cdem
