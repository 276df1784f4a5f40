// report.hpp - stress and strain energy of elements where the nodes are now.
#pragma once

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Stress and strain energy of every element where the nodes are now. `ahead`: have the nodes moved
/// since the damping of rock has?
void report_elements(const Model& model, State& state, Queue queue, bool ahead = false);

/// Stress of every element at present positions; energies stay as at the last sampled step.
void report_stress(const Model& model, State& state);

}  // namespace cdem
