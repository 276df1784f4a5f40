// candidates.hpp - which faces and edges may touch before the lists are renewed. Host code.
#pragma once

#include "core/contact/target_edge.hpp"
#include "core/model.hpp"
#include "core/state.hpp"

namespace cdem {

/// Face -> faces that it may touch; pair of faces -> pairs of their sides that may cross.
void list_candidates(const Model& model, State& state);

/// Side k of a face and side j of another as a candidate; false where intact bonds hold them
/// together.
bool pair_sides(const FaceColumns& faces, Index face_m, Index k, Index face_t, Index j,
                SidePair& pair);

/// Node -> contact rows of its exposed faces, and the motion at which each node's list is old.
void list_contact_corners(const Model& model, State& state);

}  // namespace cdem
