// sleep.hpp - fixed parts on which nothing acts are not computed.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// List the blocks of elements, bonded pairs and nodes that are awake. Asleep are tiles and
/// pairs of which all nodes are fixed, and fixed nodes at which nothing awake pulls and that no
/// pair list has: the results of the last step hold for them until the model changes. Computing
/// them again would give the same bits. (Faces that a broken bond exposes are no reason to wake:
/// bonds with a free side never sleep.)
void find_awake(const Model& model, State& state);

/// List the awake nodes after a rebuild of the pair list: nodes that were on the last one stay
/// awake until the next rebuild, since their contacts must first be reset. Finds the fused
/// blocks, too.
void list_awake_nodes(const Model& model, State& state);

}  // namespace cdem
