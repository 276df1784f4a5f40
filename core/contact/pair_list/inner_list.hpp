// inner_list.hpp - inner pair list: pairs of the outer list that can come into contact within the
// next few steps.
#pragma once

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Prune the outer list to the inner one where the inner one is too old.
void prune_pair_list_if_due(const Model& model, State& state, Queue queue);

/// Prune it, with room for the motion to come (see inner_horizon).
void prune_pair_list(const Model& model, State& state, Queue queue);

}  // namespace cdem
