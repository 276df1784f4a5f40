// health.hpp - failures of a run: outcomes, and their check.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

enum class Outcome {
  steps_done,
  time_reached,
  converged,
  not_finite,
  too_fast,
  lost_contact,
  missed_contact,
  ghosts_due  // ranks: they must be found anew before the next step
};

struct Report {
  Outcome outcome = Outcome::steps_done;
  Index culprit = -1;  // node, or exposed face for a lost contact; of ranks: in the whole model,
                       // a face by its number among all
  Real value = 0;
};

/// Are all numbers finite, all speeds below the limit, all contacts kept?
Report check_health(const Model& model, const State& state);

}  // namespace cdem
