// initial_overlaps.cpp - see initial_overlaps.hpp.
#include "core/contact/pair_list/initial_overlaps.hpp"

#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/contact/pair_list/inner_list.hpp"

namespace cdem {

InitialOverlaps adopt_overlaps(const Model& m, State& s) {
  constexpr Real reported = 1e-6;  // of L: shallower overlaps are round-off of the mesh
  SearchRules deep = m.rules;
  deep.entry = deep.depth;
  update_all_face_geometry(m, s, {});
  prune_pair_list(m, s, {});
  ResolveTargets search{face_search(m, s)};
  search.rules = deep;
  const Index exposed = Index(s.search.exposed_face.size());
  InitialOverlaps found;
  for (Index x = 0; x < exposed; ++x) {
    const Index mother = s.search.exposed_face[x];
    for (Index k = 0; k < search.faces.vertex_count(mother); ++k) {
      Index& t = s.springs.target[4 * x + k];
      s.springs.target_before[4 * x + k] = t;
      t = search.choose(x, k, search.listed_for(4 * x + k), &s.springs.lost[4 * x + k]);
      if (t < 0) continue;
      const FaceShape<Real> shape = search.faces.shape(s.search.exposed_face[t]);
      const Vec3<Real> v = search.faces.nodes.position(search.faces.vertex(mother, k));
      const Real gap = project(shape, v, shape.normal()).gap;
      ContactState spring{};
      spring.stress_free_gap = gap;
      spring.store(s.springs.state.data(), 4 * x + k);
      s.springs.target_before[4 * x + k] = t;
      if (gap > -reported * m.face_length[mother]) continue;
      ++found.count;
      if (-gap > found.deepest) found.deepest = -gap, found.face = mother;
    }
  }
  return found;
}

}  // namespace cdem
