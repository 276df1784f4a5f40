// pair_status.hpp - whether a pair of faces is still bonded.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// Of a bonded pair. A hinge holds by some of its points while the search has its faces already.
enum class PairStatus : Flag { released, bonded, hinge };

/// A pair that is not released.
CDEM_HD inline bool is_live(PairStatus status) { return status != PairStatus::released; }

}  // namespace cdem
