// initial_overlaps.hpp - blocks that overlap at the start begin free of stress.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

struct ResolveTargets;

/// Overlaps of blocks at the start.
struct InitialOverlaps {
  Index count = 0;   // vertices inside another block
  Index face = -1;   // mother face of the deepest
  Real deepest = 0;  // [m]
};

/// Set the stress-free gap of a spring (vertex k of exposed face x) that overlaps by the rules of a
/// search that the host has.
void adopt_vertex(const ResolveTargets& search, Index x, Index k, InitialOverlaps& found);

/// Set the stress-free gap of springs that overlap at the start.
InitialOverlaps adopt_overlaps(const Model& model, State& state);

}  // namespace cdem
