// stiffness_bound.hpp - the stiffness that bonds and contacts put on each node at most.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Stiffness of live bonds on each node, and the largest stiffness of contacts of its exposed faces
/// before the next rebuild of the pair list. Needs the lists of corners and of contact corners.
void sum_stiffness(const Model& model, State& state);

}  // namespace cdem
