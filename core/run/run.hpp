// run.hpp - the time loop and its functions.
#pragma once

#include <cstdint>

#include "core/diagnostics/health.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/nodes/relaxation.hpp"

namespace cdem {

/// When to come back from the loop.
struct Goal {
  std::int64_t steps = 0;    // at most
  Real end_time = 1e300;     // [s]
  Real unbalance_limit = 0;  // 0: do not look
  std::int64_t check_interval = 20;
  Relaxation relaxation = Relaxation::none;
};

/// Prepare a new or a restored state for the loop: lists and stable step.
void prepare(const Model& model, State& state);

Report run(const Model& model, State& state, const Goal& goal);

}  // namespace cdem
