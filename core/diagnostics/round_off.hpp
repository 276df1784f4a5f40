// round_off.hpp - what the round-off of positions makes where nothing happens.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// What the round-off of positions makes where nothing happens.
struct RoundOff {
  Real shift;  // of a node  [m]
  Real force;  // sum over the nodes  [N]
  RoundOff(const Model& model, const State& state);
};

}  // namespace cdem
