// step.hpp - one time step.
#pragma once

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/records/step_plan.hpp"

namespace cdem {

/// Advance the state by one time step: contacts, elements, nodes.
void step(const Model& model, State& state, Queue queue, const StepPlan& plan);

}  // namespace cdem
