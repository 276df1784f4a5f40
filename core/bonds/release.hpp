// release.hpp - broken pairs are released to the contact search; hinges open.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Raise a flag of an Answer if a broken pair has moved so far that its faces must be released at
/// once.
void ask_if_release_is_due(const Model& model, const State& state, Flag* answer);

/// Release broken pairs that have moved apart or along each other, and open the faces of hinges.
/// Returns whether any pair was released.
bool release_bonds(const Model& model, State& state);

}  // namespace cdem
