// unbalance.hpp - how far the forces are from balance.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Sum of the unbalanced forces of the last sampled step over the sum of the applied ones  [1].
Real unbalance_ratio(const Model& model, const State& state);

}  // namespace cdem
