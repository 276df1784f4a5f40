// bonds.hpp - front door: forces of bonded pairs.
#pragma once

#include "core/base/device.hpp"
#include "core/bonds/transfer_to_contact.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/records/step_plan.hpp"

namespace cdem {

/// Force of every bond point, Eq. 13-14.
void update_bond_forces(const Model& model, State& state, Queue queue, const StepPlan& plan);

}  // namespace cdem
