// take_out.hpp - blocks that leave the computation. Host code.
#pragma once

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

/// Expose the faces with a flag, and no others, see `renew_exposed`; losses of the contacts of
/// faces that leave stay in the ledger.
void change_exposed(const Model& model, State& state, const Column<Flag>& open);

/// Energy that counts as stored  [J].
Real stored_energy(const Model& model, const State& state);

}  // namespace cdem
