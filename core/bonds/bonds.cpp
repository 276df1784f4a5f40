// bonds.cpp - see bonds.hpp.
#include "core/bonds/bonds.hpp"

#include "core/base/parallel.hpp"
#include "core/bonds/views.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/model/block_lists.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

template <Index count>
void update_conforming(const Model& m, State& s, Queue q, const PairSet& p, PairState& ps,
                       Real indentation, const StepPlan& plan) {
  for_each_lane(q, p.count, awake(plan, ps.awake),
                ConformingBonds<count>{
                    .nodes = {s.nodes.motion.data()},
                    .pair_nodes = {p.nodes.data(), p.stride},
                    .pairs = pair_columns(m, p, ps),
                    .indentation = indentation,
                    .dt = s.dt_last,
                    .sampled = plan.sample || plan.everything_awake,
                    .corner_force = {s.corner_force.data() + std::size_t(p.corner_first) * 4}});
}

}  // namespace

void update_bond_forces(const Model& m, State& s, Queue q, const StepPlan& plan) {
  const PhaseTimer timer(s, Phase::contact);
  update_conforming<3>(m, s, q, m.triangles, s.triangles, m.bond_indentation_triangle, plan);
  update_conforming<4>(m, s, q, m.quads, s.quads, m.bond_indentation_quad, plan);
  const PairSet& p = m.overlaps;
  for_each_item(
      q, p.count, awake(plan, s.overlaps.awake),
      OverlapBonds{.faces = face_columns(m, s),
                   .pair_faces = p.faces.data(),
                   .point_first = p.point_first.data(),
                   .weights_a = p.weights_a.data(),
                   .weights_b = p.weights_b.data(),
                   .point_area = p.point_area.data(),
                   .pairs = pair_columns(m, p, s.overlaps),
                   .corner_force = {s.corner_force.data() + std::size_t(p.corner_first) * 4}});
}

}  // namespace cdem
