// candidates.hpp - which faces and edges may touch before the lists are renewed. Host code.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "core/contact/target_edge.hpp"
#include "core/model.hpp"
#include "core/state.hpp"

namespace cdem {

/// What live bonds of overlaps look after, as sorted keys.
struct Bonded {
  using Pairs = std::vector<std::pair<Index, Index>>;
  Pairs faces;     // exposed face and the one it is bonded to
  Pairs vertices;  // node of a bonded face and exposed face that it is bonded to

  static bool among(const Pairs& pairs, Index a, Index b) {
    return std::binary_search(pairs.begin(), pairs.end(), std::pair(a, b));
  }
};
Bonded live_overlaps(const Model& m, const State& s);

/// Face -> faces that it may touch; pair of faces -> pairs of their sides that may cross.
void list_candidates(const Model& model, State& state);

/// Side k of a face and side j of another as a candidate; false where intact bonds hold them
/// together.
bool pair_sides(const FaceColumns& faces, Index face_m, Index k, Index face_t, Index j,
                SidePair& pair);

/// Node -> contact rows of its exposed faces, and the motion at which each node's list is old.
void list_contact_corners(const Model& model, State& state);

}  // namespace cdem
