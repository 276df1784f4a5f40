// deep_overlaps.hpp - elements of different blocks that overlap deeper at the start than contacts
// can hold.
#pragma once

#include "core/contact/pair_list/initial_overlaps.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Overlaps at the start that no contact holds.
struct DeepOverlaps {
  Index count = 0;            // pairs of elements
  Index block[2] = {-1, -1};  // of the deepest pair
  Real depth = 0;             // by which that pair must be moved apart, at least  [m]
  Real allowed = 0;           // depth at which its contacts begin by themselves  [m]
  Vec3<Real> place{0, 0, 0};  // middle of the intersection of both boxes  [m]
};

/// Find them, once `adopt_overlaps` has accepted overlaps that contacts can hold. Vertices that the
/// first step
/// would hold deep inside an element are adopted too, and counted. Blocks that cannot move have no
/// contacts with each other and do not count.
DeepOverlaps find_deep_overlaps(const Model& model, State& state, InitialOverlaps& adopted);

}  // namespace cdem
