// close_lists.hpp - the lists of what is close: of all that may touch before the next refresh the
// few that may soon, which every step looks at. Host code.
#pragma once

#include "core/launch.hpp"
#include "core/state.hpp"

namespace cdem {

struct Model;

/// Has any watched node left the way that was foreseen for it at a time [s] by more than its skin?
/// Beyond the horizon [s] the lists take every vertex to stand still: what rests needs no new ones.
bool any_strayed(const State& state, const Column<Real>& watch, Real from, Real horizon);

/// Must the lists of what is close be made anew?
bool close_lists_are_old(const State& state);

/// Make them, with room for the motion to come (see close_way).
void list_close(const Model& model, State& state, Queue queue);

}  // namespace cdem
