// phase_timer.hpp - counts the wall time of a stage of the step.
#pragma once

#include <chrono>

#include "core/model/state.hpp"

namespace cdem {

/// Adds the time of its scope to a phase of the state.
class PhaseTimer {
 public:
  PhaseTimer(State& state, Phase phase) : state_(state), phase_(phase) {}
  PhaseTimer(const PhaseTimer&) = delete;
  PhaseTimer& operator=(const PhaseTimer&) = delete;
  ~PhaseTimer() {
    const std::chrono::duration<Real> passed = std::chrono::steady_clock::now() - start_;
    state_.seconds[int(phase_)] += passed.count();
  }

 private:
  State& state_;
  Phase phase_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace cdem
