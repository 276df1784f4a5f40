// change_bolts.hpp - bolts come and go between two runs.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Install the bolts with flag 1 where the rock is now: they are free of force, but for pretension.
void install_bolts(const Model& model, State& state, const Flag* which);

/// Remove them: what they have stored is lost.
void remove_bolts(const Model& model, State& state, const Flag* which);

}  // namespace cdem
