// excavate.hpp - blocks that are dug out, and let go of what they bore. Host code.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Between two runs, dig whole blocks out, given by a flag for each node: they are taken out, and
/// the forces that their bonds and contacts put on what stays are kept as loads (`relief`). What is
/// left of earlier ones adds to them, and all of it is left until `let_go` says otherwise.
void excavate(Model& model, State& state, const Flag* leaves);

/// From now on to a time, let go of the kept forces until this part of them is left; at once where
/// the time is now or past.
void let_go(State& state, Real part, Real end_time);

}  // namespace cdem
