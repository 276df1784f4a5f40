// bring_in.hpp - blocks added to the computation: fill, linings, and parts that wait for their
// stage. Host code.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Between two runs, place nodes of blocks that are out, given by a flag for each, and let them
/// count again; `position` has a row of 3 for every node. Python hands over their masses, elements
/// and loads before `bring_in`.
void place_nodes(State& state, const Flag* comes, const Real* position);

/// Let the blocks of these nodes act: they begin at rest and without stress, bonded to the blocks
/// below if `bonded` is set for the interface. Covered faces are no longer exposed, and their
/// contacts end; the energy stored in these is booked as taken out.
void bring_in(Model& model, State& state, const Flag* comes, const Flag* bonded);

}  // namespace cdem
