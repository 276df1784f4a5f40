// rebuild.hpp - front door: rebuild the pair list when it is due.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/records/step_plan.hpp"

namespace cdem {

/// Is the outer pair list too old? Notes whether a node has left its skin.
bool pair_list_is_due(const Model& model, State& state);

/// Release broken bonds, expose faces and rebuild the outer pair list with all that follows from
/// it: corner rows, sleep, the stable step.
void rebuild_pair_list(const Model& model, State& state, const StepPlan& plan);

/// The same with bonds and exposed faces as they are; `released`: pairs were released meanwhile.
void list_pairs_of_exposed(const Model& model, State& state, const StepPlan& plan, bool released);

}  // namespace cdem
