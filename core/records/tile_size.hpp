// tile_size.hpp - how large a tile of elements may be, see elements/tiles.hpp.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// Nodes of a tile at most: their motion and forces stay in the first cache.
inline constexpr Index most_tile_nodes = 320;

}  // namespace cdem
