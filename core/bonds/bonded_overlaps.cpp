// bonded_overlaps.cpp - see bonded_overlaps.hpp.
#include "core/bonds/bonded_overlaps.hpp"

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

Bonded live_overlaps(const Model& m, const State& s) {
  const auto status = on_host(s.overlaps.status);
  const auto faces = on_host(m.overlaps.faces), nodes = on_host(m.face_nodes);
  const auto place = on_host(s.search.face_exposed);
  Bonded bonded;
  for (Index i = 0; i < m.overlaps.count; ++i) {
    if (PairStatus(status[i]) != PairStatus::bonded) continue;
    for (Index side = 0; side < 2; ++side) {
      const Index face = faces[2 * i + side], mate = place[faces[2 * i + 1 - side]];
      bonded.faces.push_back({place[face], mate});
      for (Index k = 0; k < 4; ++k) bonded.vertices.push_back({nodes[4 * face + k], mate});
    }
  }
  std::sort(bonded.faces.begin(), bonded.faces.end());
  std::sort(bonded.vertices.begin(), bonded.vertices.end());
  return bonded;
}

}  // namespace cdem
