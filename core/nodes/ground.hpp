// ground.hpp - dashpots that modules put between nodes and the ground.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Sum the dashpots of each node that modules have now, in the order of the modules.
void list_ground(const Model& model, State& state);

}  // namespace cdem
