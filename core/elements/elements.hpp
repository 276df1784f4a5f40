// elements.hpp - front door: forces, stress and energy of elements.
#pragma once

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/records/step_plan.hpp"

namespace cdem {

/// Force of every element on its corners, Eq. 2; forces of fused blocks come with their motion.
void update_element_forces(const Model& model, State& state, Queue queue, const StepPlan& plan);

}  // namespace cdem
