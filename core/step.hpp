// step.hpp - one time step.
#pragma once

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/records/step_plan.hpp"

namespace cdem {

/// Find all forces where the nodes are now; those of fused blocks only where the plan samples.
void update_forces(const Model& model, State& state, Queue queue, const StepPlan& plan);

/// Advance the state by one time step: contacts, elements, nodes.
void step(const Model& model, State& state, Queue queue, const StepPlan& plan);

}  // namespace cdem
