// exposed_faces.hpp - the faces that can be touched, and the columns that belong to them.
#pragma once

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Flags [face] of the faces that are exposed, to be changed and given to `renew_exposed`.
Column<Flag> open_faces(const State& state);

/// Flag both faces of listed pairs.
void open_faces_of(const PairSet& set, const Column<Index>& pairs, Column<Flag>& open);

/// Expose the faces with a flag, in the order of the model, in which faces that are near each other
/// mostly lie together, also in memory. Contacts of new ones begin empty; faces without a flag
/// leave, with their contacts. All columns of exposed faces follow, but for those of the search,
/// which is to be made anew; where no face comes or leaves, nothing is done.
void renew_exposed(const Model& model, State& state, const Column<Flag>& open);

/// Make the table of exposed faces, after a rebuild of the pair list or a restart.
void list_exposed(const Model& model, State& state);

/// Renew centre, normal and sharp sides of every exposed face: those sides only where the pair list
/// names the face.
void update_face_geometry(const Model& model, State& state, Queue queue);
/// The same of all exposed faces, whatever the pair list.
void update_all_face_geometry(const Model& model, State& state, Queue queue);

}  // namespace cdem
