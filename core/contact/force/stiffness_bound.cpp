// stiffness_bound.cpp - see stiffness_bound.hpp.
#include "core/contact/force/stiffness_bound.hpp"

#include <algorithm>
#include <atomic>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/contact/force/unloading.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// Raise what several threads may raise at once.
void raise_to(Real& most, Real value) {
  const std::atomic_ref shared(most);
  Real now = shared.load(std::memory_order_relaxed);
  while (now < value && !shared.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
  }
}

}  // namespace

void sum_stiffness(const Model& m, State& s) {
  s.node_bonds.resize(m.node_count);
  s.node_bonds.fill(0);
  for_each_row_set(m, s, [&](auto, const auto& set, const auto& state) {
    for (Index i = 0; i < set.count; ++i)
      if (is_active(state, i))
        for_each_stiffness(m, set, i, [&](Index node, Real k) { s.node_bonds[node] += k; });
  });
  s.node_potential.resize(m.node_count);
  s.node_potential.fill(0);
  const FaceColumns faces = face_columns(m, s);
  const ContactLaws laws = contact_laws(m, s);
  const FaceGeometry geometry = face_geometry(s);
  const Index exposed = Index(s.search.exposed_face.size());
  std::vector<Real> stiffest_of(exposed);  // contact that a face may have  [N/m]
#pragma omp parallel for schedule(static, 128) if (exposed >= worth_threads)
  for (Index y = 0; y < exposed; ++y)
    for (Index c = s.search.outer.acting_first[y]; c < s.search.outer.acting_first[y + 1]; ++c) {
      const Index x = s.search.outer.faces_acting_on[c];
      const Index interface = laws.between(geometry, x, y);
      const auto spring = laws.spring(geometry, interface, x, y);
      Real most = HystereticUnloading<Real>::of(laws, interface).stiffness(spring);
      // the rotation springs of four vertices, see UpdateRollingCouples
      if (m.interfaces[interface].rolling_resistance > 0) most += 2 * spring.n();
      for (const Index face : {x, y}) raise_to(stiffest_of[face], most);
    }
  for (Index x = 0; x < exposed; ++x) {  // either side's semi-springs, as much again for semi-edges
    const Index face = s.search.exposed_face[x];
    for (Index v = 0; v < faces.vertex_count(face); ++v)
      s.node_potential[faces.vertex(face, v)] += 2 * stiffest_of[x];
  }
}

}  // namespace cdem
