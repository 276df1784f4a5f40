// initial_overlaps.hpp - blocks that overlap at the start begin free of stress.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Overlaps of blocks at the start.
struct InitialOverlaps {
  Index count = 0;   // vertices inside another block
  Index face = -1;   // mother face of the deepest
  Real deepest = 0;  // [m]
};

/// Set the stress-free gap of springs that overlap at the start.
InitialOverlaps adopt_overlaps(const Model& model, State& state);

}  // namespace cdem
