// step_plan.hpp - what one step does besides the physics that every step does.
#pragma once

namespace cdem {

/// Modes of a step, decided before it begins. None of them changes how anything moves, but
/// `stop_motion`.
struct StepPlan {
  bool sample = false;            // sample energies and unbalanced forces
  bool everything_awake = false;  // compute what sleeps too: loads or strengths may have changed
  bool stop_motion = false;  // kinetic relaxation: zero all velocities between force and motion
  bool fuse_blocks = false;  // single-element blocks without contacts take the fused kernel
};

}  // namespace cdem
