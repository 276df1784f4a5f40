// take_out.hpp - blocks that leave the computation. Host code.
#pragma once

#include <vector>

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Between two runs, take whole blocks out, given by a flag for each node. Their nodes stay where
/// they are, their elements and bonds carry nothing, their faces cannot be touched, and their
/// contacts end. Faces that were bonded to them can be touched from then on. The energy that is
/// stored in them is booked as taken out.
void take_out(Model& model, State& state, const Flag* leaves);

/// Keep removed blocks fixed, after Python has set arrays of the model.
void hold_taken_out(Model& model, State& state);

/// Hide faces, given by a flag for each; losses of their contacts stay in the ledger.
void hide_faces(State& state, const std::vector<Flag>& hidden);

/// Energy that counts as stored  [J].
Real stored_energy(const Model& model, const State& state);

}  // namespace cdem
