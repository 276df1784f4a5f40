// report.cpp - see report.hpp.
#include "core/elements/report.hpp"

#include <algorithm>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/elements/corotational.hpp"
#include "core/elements/views.hpp"

namespace cdem {

namespace {

template <class Shape, class Rotation>
void report_set(const Model& m, State& s, Queue q, const ElementSet& e, ElementState& es) {
  for_each_lane(q, e.count,
                CorotationalReport<Shape, Rotation>{element_columns<Shape>(m, s, e),
                                                    {es.stress.data(), e.stride},
                                                    {es.energy.data(), e.stride},
                                                    point_flow<Shape>(s, e, es)});
}

/// Mean over the Gauss points of the stress that the incremental forms keep.
template <class Shape>
void average_points(const ElementSet& e, ElementState& es) {
  for (Index i = 0; i < e.count; ++i)
    for (Index row = 0; row < 6; ++row) {
      Real sum = 0, volume = 0;
      for (Index q = 0; q < Shape::points; ++q) {
        const Real w = e.volume[std::size_t(q) * e.stride + i];
        sum += w * es.point_stress[std::size_t(6 * q + row) * e.stride + i];
        volume += w;
      }
      es.stress[std::size_t(row) * e.stride + i] = sum / volume;
    }
}

template <class Shape>
void report_shape(const Model& m, State& s, Queue q, const ElementSet& e, ElementState& es) {
  switch (m.formulation) {
    case Formulation::corotational:
      return report_set<Shape, FollowRotation>(m, s, q, e, es);
    case Formulation::paper_total:
      return report_set<Shape, IgnoreRotation>(m, s, q, e, es);
    default:
      return average_points<Shape>(e, es);
  }
}

}  // namespace

/// Stress and strain energy of every element where the nodes are now.
void report_elements(const Model& m, State& s, Queue q) {
  report_shape<Tet4>(m, s, q, m.tet4, s.tet4);
  report_shape<Pyramid5>(m, s, q, m.pyramid5, s.pyramid5);
  report_shape<Wedge6>(m, s, q, m.wedge6, s.wedge6);
  if (m.hex8.hourglass.size() > 0)
    report_shape<Hex8OnePoint>(m, s, q, m.hex8, s.hex8);
  else
    report_shape<Hex8>(m, s, q, m.hex8, s.hex8);
  finish(q);
}

void report_stress(const Model& m, State& s) {
  ElementState* sets[] = {&s.tet4, &s.pyramid5, &s.wedge6, &s.hex8};
  // the ledger's strain energy belongs to the last sampled step, the stress to where nodes are now
  std::vector<Real> energy[4];
  for (int k = 0; k < 4; ++k)
    energy[k].assign(sets[k]->energy.data(), sets[k]->energy.data() + sets[k]->energy.size());
  report_elements(m, s, {});
  for (int k = 0; k < 4; ++k) std::copy(energy[k].begin(), energy[k].end(), sets[k]->energy.data());
}

}  // namespace cdem
