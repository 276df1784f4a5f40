// round_off.hpp - forces from round-off of positions at rest.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Forces from round-off of positions at rest.
struct RoundOff {
  Real shift;  // of a node  [m]
  Real force;  // sum over the nodes  [N]
  RoundOff(const Model& model, const State& state);
};

}  // namespace cdem
