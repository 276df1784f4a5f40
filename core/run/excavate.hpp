// excavate.hpp - blocks that are removed, and the release of their forces. Host code.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Between two runs, remove whole blocks, given by a flag for each node. The forces of their bonds
/// and contacts on the rest are kept as loads (`relief`), together with the remainder of earlier
/// ones, until `release_forces` releases them.
void excavate(Model& model, State& state, const Flag* leaves);

/// From now to a given time, release the kept forces down to this fraction; at once if
/// the time is now or past.
void release_forces(State& state, Real part, Real end_time);

}  // namespace cdem
