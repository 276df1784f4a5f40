// vertex_face_pairs.hpp - which vertices of one patch may touch faces of another.
#pragma once

#include "core/contact/broad_phase/separating_planes.hpp"

namespace cdem {

/// List the vertices of one patch that may touch faces of another.
void list_touches(const Finder& finder, const Patch& a, const Patch& b, const FacePairs& pairs,
                  const Beyond& beyond, bool reverse, Met& met, Proximity& found);

}  // namespace cdem
