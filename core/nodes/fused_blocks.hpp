// free_blocks.hpp - finds the blocks of one element of which only their bonds know. Host code.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Find, among what is awake, blocks of one tet or hexahedron on which nothing but their own
/// forces, bonds and weight acts, and list what their nodes sum. They may go apart from the other
/// blocks, see AdvanceFused. Only with the default formulation and full mass matrices.
void find_fused_blocks(const Model& model, State& state);

}  // namespace cdem
