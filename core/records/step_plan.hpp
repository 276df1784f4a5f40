// step_plan.hpp - tasks of one step besides the physics of every step.
#pragma once

namespace cdem {

/// Modes of a step, decided before it begins. None of them changes how anything moves, but
/// `stop_motion`.
struct StepPlan {
  bool sample = false;            // sample energies and unbalanced forces
  bool everything_awake = false;  // compute sleeping items too: loads or strengths may have changed
  bool stop_motion = false;  // kinetic relaxation: zero all velocities between force and motion
  bool fuse_blocks = false;  // single-element blocks without contacts take the fused kernel
};

}  // namespace cdem
