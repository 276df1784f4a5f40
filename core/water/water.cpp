// water.cpp - see water.hpp.
#include "core/water/water.hpp"

#include "core/base/parallel.hpp"
#include "core/elements/views.hpp"
#include "core/model/force_sets.hpp"
#include "core/model/phase_timer.hpp"
#include "core/water/pressure.hpp"
#include "core/water/wet_faces.hpp"

namespace cdem {

namespace {

/// Rows of the fields in this step, see WaterFields.
void evaluate_fields(const Model& m, State& s) {
  const Water& w = m.water;
  const std::size_t count = w.fields.size() / 8;
  s.water.fields.resize(8 * count);
  const auto fields = on_host(w.fields);
  const auto curve = on_host(w.field_curve);
  const auto factor = on_host(s.load_factor), fields_now = on_host(s.water.fields);
  for (std::size_t i = 0; i < count; ++i) {
    const Real *given = fields.data() + 8 * i, lift = factor[curve[2 * i]];
    Real* now = fields_now.data() + 8 * i;
    now[0] = given[0] + given[5] * lift;
    for (std::size_t k = 1; k < 5; ++k) now[k] = given[k];
    now[5] = factor[curve[2 * i + 1]];
  }
}

template <Index count>
void press(State& s, Queue q, const WetFaces& w, const Column<Index>& field) {
  for_each_lane(q, w.count,
                PressOnFaces<count>{.nodes = {s.nodes.motion.data()},
                                    .face_nodes = {w.nodes.data(), w.stride},
                                    .field = {field.data(), w.stride},
                                    .kept = {w.kept.data(), w.stride},
                                    .fields = {s.water.fields.data()},
                                    .out = {s.water.force.data() + 4 * std::size_t(w.row_first)}});
}

void press_in_pores(const Model& m, State& s, Queue q) {
  const Water& w = m.water;
  s.water.node_pressure.resize(m.node_count);
  for_each_item(q, m.node_count,
                PoresOfNodes{.nodes = {s.nodes.motion.data()},
                             .field = w.node_field.data(),
                             .kept = w.node_kept.data(),
                             .fields = {s.water.fields.data()},
                             .pressure = s.water.node_pressure.data()});
  for_each_element_set(
      m, s, [&]<class Shape>(ElementKind<Shape>, const ElementSet& e, const ElementState&) {
        const std::size_t first = std::size_t(w.pore_row_first) + e.corner_first;
        for_each_lane(q, e.count,
                      PressInPores<Shape>{.columns = element_columns<Shape>(m, s, e),
                                          .biot = w.biot.data(),
                                          .values = e.values.data(),
                                          .pressure = s.water.node_pressure.data(),
                                          .out = {s.water.force.data() + 4 * first}});
      });
}

/// Forces on faces and corners where the nodes are now.
void find_forces(const Model& m, State& s, Queue q) {
  const Water& w = m.water;
  const bool porous = w.biot.size() > 0;
  s.water.force.resize(4 *
                       (std::size_t(w.pore_row_first) + (porous ? element_corner_count(m, s) : 0)));
  evaluate_fields(m, s);
  find_wet_faces(m, s);
  press<3>(s, q, w.triangles, s.water.triangle_field);
  press<4>(s, q, w.quads, s.water.quad_field);
  if (porous) press_in_pores(m, s, q);
}

void sum_forces(const Model& m, State& s, Queue q, Real dt) {
  s.nodes.water.resize(4 * std::size_t(m.node_count));
  s.nodes.work_water.resize(m.node_count);
  for_each_item(q, m.node_count,
                SumWaterForces{.nodes = {s.nodes.motion.data()},
                               .first = m.water.node_first.data(),
                               .row = m.water.row.data(),
                               .rows = {s.water.force.data()},
                               .dt = dt,
                               .force = s.nodes.water.data(),
                               .work = s.nodes.work_water.data()});
  finish(q);
}

}  // namespace

void update_water(const Model& m, State& s, Queue q) {
  if (m.water.fields.size() == 0) return;
  const PhaseTimer timer(s, Phase::element);
  find_forces(m, s, q);
  sum_forces(m, s, q, s.step > 0 ? s.dt_last : 0);
}

std::vector<Real> change_water(const Model& m, State& s) {
  if (m.water.fields.size() == 0) return {};
  s.nodes.water.resize(4 * std::size_t(m.node_count));
  std::vector<Real> change = fetch(s.nodes.water);
  find_forces(m, s, {});
  sum_forces(m, s, {}, 0);
  const auto now = on_host(s.nodes.water);
  for (std::size_t k = 0; k < change.size(); ++k) change[k] = now[k] - change[k];
  return change;
}

}  // namespace cdem
