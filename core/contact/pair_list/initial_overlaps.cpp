// initial_overlaps.cpp - see initial_overlaps.hpp.
#include "core/contact/pair_list/initial_overlaps.hpp"

#include <vector>

#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/contact/pair_list/inner_list.hpp"

namespace cdem {

void adopt_vertex(const ResolveTargets& search, Index x, Index k, InitialOverlaps& found) {
  constexpr Real reported = 1e-6;  // of L: shallower overlaps are round-off of the mesh
  const SpringColumns& springs = search.springs;
  const Index mother = search.exposed_face[x];
  Index& t = springs.target[4 * x + k];
  springs.target_before[4 * x + k] = t;
  const DropPassedTargets passed{search};
  FaceList listed = search.listed_for(4 * x + k);
  std::vector<Flag> may_begin(listed.count);
  for (Index c = 0; c < listed.count; ++c) may_begin[c] = !passed.passes(x, k, listed.other[c]);
  listed.may_begin = may_begin.data();
  t = search.choose(x, k, listed, &springs.lost[4 * x + k]);
  if (t < 0) return;
  const FaceShape<Real> shape = search.faces.shape(search.exposed_face[t]);
  const Vec3<Real> v = search.faces.nodes.position(search.faces.vertex(mother, k));
  const Real gap = project(shape, v, shape.normal()).gap;
  ContactState spring{};
  spring.stress_free_gap = gap;
  spring.store(springs.state, 4 * x + k);
  springs.target_before[4 * x + k] = t;
  if (gap > -reported * search.faces.face_length[mother]) return;
  ++found.count;
  if (-gap > found.deepest) found.deepest = -gap, found.face = mother;
}

InitialOverlaps adopt_overlaps(const Model& m, State& s) {
  update_all_face_geometry(m, s, {});
  prune_pair_list(m, s, {});
  ResolveTargets search = on_host(ResolveTargets{face_search(m, s)});
  search.rules.entry = search.rules.depth;
  InitialOverlaps found;
  for (Index x = 0; x < Index(s.search.exposed_face.size()); ++x)
    for (Index k = 0; k < search.faces.vertex_count(search.exposed_face[x]); ++k)
      adopt_vertex(search, x, k, found);
  return found;
}

}  // namespace cdem
