// nodes.hpp - front door: from forces to motion.
#pragma once

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/nodes/curves.hpp"
#include "core/nodes/time_step.hpp"
#include "core/records/step_plan.hpp"

namespace cdem {

/// Sum the forces on every node and move it by one step; sample energies and stop all motion in
/// between where the plan says so.
void advance_nodes(const Model& model, State& state, Queue queue, const StepPlan& plan);

/// Sum the forces on every node, and move none.
void sum_forces(const Model& model, State& state, Queue queue, const StepPlan& plan);

/// Set the largest speeds of all nodes to 0.
void begin_peaks(const Model& model, State& state);

/// Does damping act on the nodes?
bool damps_nodes(const Model& model, const State& state);

/// Kinetic energy of the last sampled step  [J].
Real kinetic_energy(const Model& model, const State& state);

}  // namespace cdem
