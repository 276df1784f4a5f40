// report.cpp - see report.hpp.
#include "core/elements/report.hpp"

#include <algorithm>
#include <type_traits>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/elements/corotational.hpp"
#include "core/elements/nodal_mean.hpp"
#include "core/elements/views.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

template <class Shape, class Rotation>
void report_set(const Model& m, State& s, Queue q, const ElementSet& e, ElementState& es,
                bool ahead) {
  const bool averaged = e.nodal_mean.size() > 0 && report_averaged_tets(m, s, q, ahead);
  const auto report = [&]<class Damping>(const Damping& damping) {
    for_each_lane(q, e.count, averaged ? other_tets(s) : Blocks{},
                  CorotationalReport<Shape, Rotation, PointFlow<Shape>, Damping>{
                      .columns = element_columns<Shape>(m, s, e),
                      .stress = {es.stress.data(), e.stride},
                      .energy = {es.energy.data(), e.stride},
                      .yielded = {es.yielded.size() > 0 ? es.yielded.data() : nullptr, e.stride},
                      .flow = point_flow<Shape>(s, e, es),
                      .damping = damping});
  };
  if constexpr (std::is_same_v<Rotation, FollowRotation>)
    if (remembers(es)) return report(rock_damping<Shape>(m, s, e, es, ahead));
  report(NoRockDamping{});
}

/// Mean over the Gauss points of the stress that the incremental forms keep.
template <class Shape>
void average_points(const ElementSet& e, ElementState& es) {
  const auto volumes = on_host(e.volume);
  const auto point_stress = on_host(es.point_stress), stress = on_host(es.stress);
  for (Index i = 0; i < e.count; ++i)
    for (Index row = 0; row < 6; ++row) {
      Real sum = 0, volume = 0;
      for (Index q = 0; q < Shape::points; ++q) {
        const Real w = volumes[std::size_t(q) * e.stride + i];
        sum += w * point_stress[std::size_t(6 * q + row) * e.stride + i];
        volume += w;
      }
      stress[std::size_t(row) * e.stride + i] = sum / volume;
    }
}

template <class Shape>
void report_shape(const Model& m, State& s, Queue q, const ElementSet& e, ElementState& es,
                  bool ahead) {
  switch (m.formulation) {
    case Formulation::corotational:
      return report_set<Shape, FollowRotation>(m, s, q, e, es, ahead);
    case Formulation::paper_total:
      return report_set<Shape, IgnoreRotation>(m, s, q, e, es, ahead);
    default:
      return average_points<Shape>(e, es);
  }
}

}  // namespace

void report_elements(const Model& m, State& s, Queue q, bool ahead) {
  for_each_element_set(m, s,
                       [&]<class Shape>(ElementKind<Shape>, const ElementSet& e, ElementState& es) {
                         report_shape<Shape>(m, s, q, e, es, ahead);
                       });
  finish(q);
}

void report_stress(const Model& m, State& s) {
  // the ledger's strain energy belongs to the last sampled step, the stress to where nodes are now
  std::vector<std::vector<Real>> energy;
  for_each_element_set(m, s, [&](auto, const ElementSet&, const ElementState& es) {
    energy.push_back(fetch(es.energy));
  });
  report_elements(m, s, {}, true);
  auto before = energy.begin();
  for_each_element_set(
      m, s, [&](auto, const ElementSet&, ElementState& es) { es.energy.assign(*before++); });
}

}  // namespace cdem
