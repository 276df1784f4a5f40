// applied.hpp - front door: modules act, and nodes sum the forces that modules apply from outside.
#pragma once

#include <vector>

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Let the modules of a stage act. Applied forces are summed on nodes, with their work since the
/// last step.
void act_of_modules(const Model& model, State& state, Queue queue, Stage stage);

/// Add the forces of several modules at each node.
void add_applied(const Model& model, State& state);

/// Find applied forces at the start, or after blocks were taken out: no time passes. Returns the
/// change of the force on each node, rows of 4 [N]; none where there are none.
std::vector<Real> change_applied(const Model& model, State& state);

}  // namespace cdem
