// fused_blocks.hpp - finds the blocks that the fused kernel moves. Host code.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Find the awake blocks of one tet or hexahedron on which only their own forces, bonds and weight
/// act, and list the rows that their nodes sum. The fused kernel moves them, see AdvanceFused. Only
/// with the default formulation, and not while relaxation scales masses.
void find_fused_blocks(const Model& model, State& state);

}  // namespace cdem
