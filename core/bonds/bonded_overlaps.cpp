// bonded_overlaps.cpp - see bonded_overlaps.hpp.
#include "core/bonds/bonded_overlaps.hpp"

namespace cdem {

Bonded live_overlaps(const Model& m, const State& s) {
  Bonded bonded;
  for (Index i = 0; i < m.overlaps.count; ++i) {
    if (PairStatus(s.overlaps.status[i]) != PairStatus::bonded) continue;
    for (Index side = 0; side < 2; ++side) {
      const Index face = m.overlaps.faces[2 * i + side];
      const Index mate = s.search.face_exposed[m.overlaps.faces[2 * i + 1 - side]];
      bonded.faces.push_back({s.search.face_exposed[face], mate});
      for (Index k = 0; k < 4; ++k) bonded.vertices.push_back({m.face_nodes[4 * face + k], mate});
    }
  }
  std::sort(bonded.faces.begin(), bonded.faces.end());
  std::sort(bonded.vertices.begin(), bonded.vertices.end());
  return bonded;
}

}  // namespace cdem
