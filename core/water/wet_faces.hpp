// wet_faces.hpp - which water presses on the vertices of faces.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Find for each vertex of wet faces the field that presses on it.
///
/// Water of the joint presses while the face's bonds are whole or broken, as its interface has it;
/// once they are released, on vertices that are in contact, or no farther than the aperture from
/// a face that was bonded to theirs. On all others water in the open presses, if there is any.
void find_wet_faces(const Model& model, State& state);

}  // namespace cdem
