// elements.cpp - see elements.hpp.
#include "core/elements/elements.hpp"

#include "core/base/parallel.hpp"
#include "core/elements/corotational.hpp"
#include "core/elements/incremental.hpp"
#include "core/elements/nodal_mean.hpp"
#include "core/elements/views.hpp"
#include "core/model/block_lists.hpp"
#include "core/model/force_sets.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

template <class Shape>
void update_elements(const Model& m, State& s, Queue q, const ElementSet& e, ElementState& es,
                     Blocks some) {
  const ElementColumns<Shape> columns = element_columns<Shape>(m, s, e);
  const Tiles tiles = tiles_of(e, es, s);
  const InOutTable work{es.damping_work.data(), e.stride}, energy{es.energy.data(), e.stride};
  const InOutTable stress{es.point_stress.data(), e.stride};
  const auto total = [&]<class Rotation, class Flow, class Damping = NoRockDamping>(
                         const Flow& flow, const Damping& damping = {}) {
    for_each_tile(q, e.count, some, tiles,
                  CorotationalForce<Shape, Rotation, Flow, Damping>{
                      .columns = columns,
                      .damping_time = m.stiffness_damping * s.dt,
                      .dt = s.dt,
                      .damping_work = work,
                      .flow = flow,
                      .damping = damping});
  };
  const auto incremental = [&]<class Turning>() {
    for_each_tile(q, e.count, some, tiles,
                  IncrementalForce<Shape, Turning>{
                      .columns = columns, .dt = s.dt_last, .stress = stress, .energy = energy});
  };
  switch (m.formulation) {
    case Formulation::corotational:
      if (remembers(es))
        return total.template operator()<FollowRotation>(point_flow<Shape>(s, e, es),
                                                         rock_damping<Shape>(m, s, e, es, false));
      return with_flow<Shape>(
          s, e, es, [&](const auto& flow) { total.template operator()<FollowRotation>(flow); });
    case Formulation::paper_total:  // a case with a law that flows does not have it
      return total.template operator()<IgnoreRotation>(NoFlow{});
    case Formulation::incremental:
      return incremental.template operator()<TurnByHalves>();
    case Formulation::paper_incremental:
      return incremental.template operator()<NeverTurn>();
  }
}

}  // namespace

void update_element_forces(const Model& m, State& s, Queue q, const StepPlan& plan) {
  const PhaseTimer timer(s, Phase::element);
  const bool fuses = fuses_blocks(s, plan);
  for_each_element_set(m, s,
                       [&]<class Shape>(ElementKind<Shape>, const ElementSet& e, ElementState& es) {
                         Blocks some = awake(plan, fuses ? es.fused.general : es.awake);
                         if (e.nodal_mean.size() > 0 && !some.id) some = other_tets(s);
                         update_elements<Shape>(m, s, q, e, es, some);
                       });
  if (has_nodal_means(m)) update_averaged_tets(m, s, q);
}

}  // namespace cdem
