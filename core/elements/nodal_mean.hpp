// nodal_mean.hpp - passes over tets and nodes before the forces of tets with a nodal mean.
#pragma once

#include "core/base/device.hpp"
#include "core/base/parallel.hpp"
#include "core/elements/nodal_dilatation.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/records/step_plan.hpp"

namespace cdem {

/// Does the model have tets whose dilatation is averaged at the nodes?
inline bool has_nodal_means(const Model& m) { return m.tet4.nodal_mean.size() > 0; }

/// List the blocks of tets and nodes that have some, and make room.
void list_nodal_means(const Model& model, State& state);

/// Passes 1 and 2: the laws of the tets move on, and their dilatation is averaged.
void update_nodal_means(const Model& model, State& state, Queue queue);

/// Dilatation at the nodes where they are now, for the report; nothing moves on. Returns whether
/// it is known: before the first step it is not, and no tet differs from its nodes.
bool find_nodal_means(const Model& model, State& state, Queue queue);

/// What pass 3 and the report have instead of PointFlow.
NodalFlow nodal_flow(const Model& model, State& state);
NodalReport nodal_report(const Model& model, State& state);

/// Blocks of tets with one that is averaged, and the other ones.
Blocks averaged_tets(const State& state);
Blocks other_tets(const State& state);

}  // namespace cdem
