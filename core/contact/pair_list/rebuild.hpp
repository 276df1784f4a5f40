// rebuild.hpp - front door: rebuild the pair list when it is due.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/records/step_plan.hpp"

namespace cdem {

/// At the end of a step: ask whether the pair lists are too old for the next one. It reads the
/// answers, so that the host waits for them together with others.
void ask_what_is_due(const Model& model, State& state);

/// Is the outer pair list too old? Notes whether a node has left its skin of either list. Asks,
/// unless that was done at the end of the step before.
bool pair_list_is_due(const Model& model, State& state);

/// The same ahead of a step, whose own question then gets this answer.
bool foresee_rebuild(const Model& model, State& state);

/// Release broken bonds, expose faces and rebuild the outer pair list with all that follows from
/// it: corner rows, sleep, the stable step.
void rebuild_pair_list(const Model& model, State& state, const StepPlan& plan);

/// The same with bonds and exposed faces as they are; `released`: pairs were released meanwhile.
void list_pairs_of_exposed(const Model& model, State& state, const StepPlan& plan, bool released);

}  // namespace cdem
