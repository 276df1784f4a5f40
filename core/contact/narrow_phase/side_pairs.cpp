// side_pairs.cpp - see side_pairs.hpp.
#include "core/contact/narrow_phase/side_pairs.hpp"

namespace cdem {

bool pair_sides(const FaceColumns& faces, Index face_m, Index k, Index face_t, Index j,
                Index& shared) {
  const Index km = k + 1 == faces.vertex_count(face_m) ? 0 : k + 1;
  const Index jt = j + 1 == faces.vertex_count(face_t) ? 0 : j + 1;
  const Index mother[2] = {faces.vertex(face_m, k), faces.vertex(face_m, km)};
  const Index target[2] = {faces.vertex(face_t, j), faces.vertex(face_t, jt)};
  shared = 0;
  for (Index i = 0; i < 4; ++i) {
    const Index a = mother[i >> 1], b = target[i & 1];
    if (faces.bonded_node[a] == faces.bonded_node[b]) return false;
    if (faces.node_place[a] == faces.node_place[b]) shared |= 1 << i;
  }
  return true;
}

}  // namespace cdem
