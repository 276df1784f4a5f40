// side_pairs.hpp - sides of two faces as a pair that may touch.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"
#include "core/contact/narrow_phase/edge_pair.hpp"

namespace cdem {

/// Side k of a face and side j of another as a candidate; false where intact bonds hold them
/// together.
bool pair_sides(const FaceColumns& faces, Index face_m, Index k, Index face_t, Index j,
                SidePair& pair);

}  // namespace cdem
