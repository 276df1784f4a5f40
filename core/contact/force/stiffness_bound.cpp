// stiffness_bound.cpp - see stiffness_bound.hpp.
#include "core/contact/force/stiffness_bound.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/geometry/views.hpp"

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
  const auto conforming = [&](const PairSet& p, const PairState& ps) {
    for (Index i = 0; i < p.count; ++i) {
      if (!(ps.live[i] > 0)) continue;
      const Real k = std::max(p.stiffness[i], p.stiffness[std::size_t(p.stride) + i]);
      for (Index c = 0; c < 2 * p.points; ++c)
        s.node_bonds[p.nodes[std::size_t(c) * p.stride + i]] += k * p.area[i] / p.points;
    }
  };
  conforming(m.triangles, s.triangles);
  conforming(m.quads, s.quads);
  const PairSet& p = m.overlaps;
  for (Index i = 0; i < p.count; ++i) {
    if (!(s.overlaps.live[i] > 0)) continue;
    const Real k = std::max(p.stiffness[i], p.stiffness[std::size_t(p.stride) + i]);
    for (Index c = p.point_first[i]; c < p.point_first[i + 1]; ++c)
      for (Index v = 0; v < 4; ++v) {
        const Index a = m.face_nodes[4 * p.faces[2 * i] + v];
        const Index b = m.face_nodes[4 * p.faces[2 * i + 1] + v];
        if (a >= 0) s.node_bonds[a] += k * p.point_area[c] * std::abs(p.weights_a[4 * c + v]);
        if (b >= 0) s.node_bonds[b] += k * p.point_area[c] * std::abs(p.weights_b[4 * c + v]);
      }
  }

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
      const auto spring = laws.spring(geometry, laws.between(geometry, x, y), x, y);
      for (const Index face : {x, y}) raise_to(stiffest_of[face], std::max(spring.n(), spring.s()));
    }
  for (Index x = 0; x < exposed; ++x) {  // either side's semi-springs, as much again for semi-edges
    const Index face = s.search.exposed_face[x];
    for (Index v = 0; v < faces.vertex_count(face); ++v)
      s.node_potential[faces.vertex(face, v)] += 2 * stiffest_of[x];
  }
}

}  // namespace cdem
