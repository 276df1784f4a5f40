// bolts.hpp - the front door of bolts: forces of a step, and cutting where rock is dug out.
#pragma once

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Bring all bolts that act into equilibrium and write their forces into their corner rows.
void update_bolt_forces(const Model& model, State& state, Queue queue);

/// Cut a bolt's bars, and drop its grout, in rock that was dug out.
void cut_bolt(const BoltSet& bolts, const Flag* out, BoltState& state, Index bolt);

}  // namespace cdem
