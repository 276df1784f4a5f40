// exposed_faces.hpp - the faces that can be touched, and the columns that belong to them.
#pragma once

#include <vector>

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Expose a face to contacts, if it is not exposed yet; its contacts begin empty.
void expose(State& state, Index face);

/// Put exposed faces into the order of the model, in which faces that are near each other mostly
/// lie together, also in memory.
void sort_exposed(State& state);

/// Make these faces [face] ones that cannot be touched any more: they and their contacts leave.
void hide(State& state, const std::vector<Flag>& hidden);

/// Make the table of exposed faces, after a rebuild of the pair list or a restart.
void list_exposed(const Model& model, State& state);

/// Renew centre, normal and sharp sides of every exposed face: those sides only where the pair list
/// names the face.
void update_face_geometry(const Model& model, State& state, Queue queue);
/// The same of all exposed faces, whatever the pair list.
void update_all_face_geometry(const Model& model, State& state, Queue queue);

}  // namespace cdem
