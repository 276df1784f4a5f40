// side_pairs.hpp - sides of two faces as a pair that may touch.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"

namespace cdem {

/// Side k of a face and side j of another as a candidate; false where intact bonds hold them
/// together. Bit 2 a + b of `shared`: end a of the one and end b of the other began at the same
/// place in the mesh.
bool pair_sides(const FaceColumns& faces, Index face_m, Index k, Index face_t, Index j,
                Index& shared);

}  // namespace cdem
