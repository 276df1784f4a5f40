// nodal_mean.hpp - tets whose dilatation is averaged at their nodes, see nodal_dilatation.hpp.
#pragma once

#include "core/base/device.hpp"
#include "core/base/parallel.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Does the model have tets whose dilatation is averaged at the nodes?
inline bool has_nodal_means(const Model& m) { return m.tet4.nodal_mean.size() > 0; }

/// List the blocks of tets and nodes that have some, and make room.
void list_nodal_means(const Model& model, State& state);

/// Passes 1 and 2: the laws of these tets move on, and their dilatation is averaged.
void update_nodal_means(const Model& model, State& state, Queue queue);

/// Pass 3: their forces.
void update_averaged_tets(const Model& model, State& state, Queue queue);

/// Stress and energy of these tets where the nodes are now. Returns false where no step has begun
/// yet: they are as other tets then. `ahead`: see report_elements.
bool report_averaged_tets(const Model& model, State& state, Queue queue, bool ahead);

/// Blocks of tets without an averaged one.
Blocks other_tets(const State& state);

}  // namespace cdem
