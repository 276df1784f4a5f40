// bring_in.hpp - blocks that come into the computation: fill, linings, and what waits for its
// stage. Host code.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Between two runs, place nodes of blocks that are out, given by a flag for each, and let them
/// count again; `position` has a row of 3 for every node. Python hands over their masses, elements
/// and loads before `bring_in`.
void place_nodes(State& state, const Flag* comes, const Real* position);

/// Let the blocks of these nodes act: they begin at rest and without stress, bonded to what they
/// lie on where `bonded` says so for the interface. Faces that this covers cannot be touched any
/// more, and their contacts end; the energy that those stored is booked as taken out.
void bring_in(Model& model, State& state, const Flag* comes, const Flag* bonded);

}  // namespace cdem
