// bonded_overlaps.hpp - faces and vertices that bonds of overlapping faces keep from the search.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/lanes.hpp"

namespace cdem {

struct Model;
struct State;

/// Faces and vertices that bonds of overlaps hold, hinges left out, as sorted keys.
struct Bonded {
  using Pairs = std::vector<std::pair<Index, Index>>;
  Pairs faces;     // exposed face and the one it is bonded to
  Pairs vertices;  // node of a bonded face and exposed face that it is bonded to

  static bool among(const Pairs& pairs, Index a, Index b) {
    return std::binary_search(pairs.begin(), pairs.end(), std::pair(a, b));
  }
};
Bonded live_overlaps(const Model& m, const State& s);

}  // namespace cdem
