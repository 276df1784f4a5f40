// stiffness_bound.cpp - see stiffness_bound.hpp.
#include "core/contact/force/stiffness_bound.hpp"

#include <algorithm>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/contact/force/unloading.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// Raise a value that several threads may raise at once.
void raise_to(Real& most, Real value) {
  constexpr int order = __ATOMIC_RELAXED;
  Real now;
  __atomic_load(&most, &now, order);
  while (now < value && !__atomic_compare_exchange(&most, &now, &value, true, order, order)) {
  }
}

}  // namespace

void sum_stiffness(const Model& m, State& s) {
  std::vector<Real> bonds(m.node_count), potential(m.node_count);
  for_each_row_set(m, s, [&](auto, const auto& set, const auto& state) {
    const auto is_active = activity(state);
    const auto for_each_stiffness = stiffness_of(m, set);
    for (Index i = 0; i < set.count; ++i)
      if (is_active(i)) for_each_stiffness(i, [&](Index node, Real k) { bonds[node] += k; });
  });
  Modules::for_each_of<Port::applied>([&]<class Module>() {
    if constexpr (requires { Module::stiffness_of(given_of<Module>(m)); })
      Module::stiffness_of(given_of<Module>(m))([&](Index node, Real k) { bonds[node] += k; });
  });
  const FaceColumns faces = on_host(face_columns(m, s));
  const ContactLaws laws = on_host(contact_laws(m, s));
  const FaceGeometry geometry = on_host(face_geometry(s));
  const auto acting_first = on_host(s.search.outer.acting_first);
  const auto acting = on_host(s.search.outer.faces_acting_on);
  const auto exposed_face = on_host(s.search.exposed_face);
  const Index exposed = Index(s.search.exposed_face.size());
  std::vector<Real> stiffest_of(exposed);  // contact that a face may have  [N/m]
#pragma omp parallel for schedule(static, 128) if (exposed >= worth_threads)
  for (Index y = 0; y < exposed; ++y)
    for (Index c = acting_first[y]; c < acting_first[y + 1]; ++c) {
      const Index x = acting[c];
      const Index interface = laws.between(geometry, x, y);
      const auto spring = laws.spring(geometry, interface, x, y);
      Real most = HystereticUnloading<Real>::of(laws, interface).stiffness(spring);
      // the rotation springs of four vertices, see UpdateRollingCouples
      if (laws.interfaces.interfaces[interface].rolling_resistance > 0) most += 2 * spring.n();
      for (const Index face : {x, y}) raise_to(stiffest_of[face], most);
    }
  for (Index x = 0; x < exposed; ++x) {  // either side's semi-springs, as much again for semi-edges
    const Index face = exposed_face[x];
    for (Index v = 0; v < faces.vertex_count(face); ++v)
      potential[faces.vertex(face, v)] += 2 * stiffest_of[x];
  }
  s.node_bonds.assign(bonds);
  s.node_potential.assign(potential);
}

}  // namespace cdem
