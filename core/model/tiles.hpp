// tiles.hpp - divides elements into tiles. Host code.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Divide the elements of every set into tiles, and give each node a row for each of its tiles, in
/// the order of the sets and of their elements.
void list_tiles(const Model& model, State& state);

/// List the corners at each node of a tile: a GPU sums node by node. Part of list_tiles there.
void list_tile_corners(const Model& model, State& state);

}  // namespace cdem
