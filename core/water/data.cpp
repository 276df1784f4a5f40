// data.cpp - see data.hpp.
#include "core/water/data.hpp"

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
  const WaterSet& w = given_of<Water>(m);
  const std::size_t count = w.fields.size() / 8;
  state_of<Water>(s).fields.resize(8 * count);
  const auto fields = on_host(w.fields);
  const auto curve = on_host(w.field_curve);
  const auto factor = on_host(s.load_factor), fields_now = on_host(state_of<Water>(s).fields);
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
                PressOnFaces<count>{
                    .nodes = {s.nodes.motion.data()},
                    .face_nodes = {w.nodes.data(), w.stride},
                    .field = {field.data(), w.stride},
                    .kept = {w.kept.data(), w.stride},
                    .fields = {state_of<Water>(s).fields.data()},
                    .out = {applied_of<Water>(s).rows.data() + 4 * std::size_t(w.row_first)}});
}

void press_in_pores(const Model& m, State& s, Queue q) {
  const WaterSet& w = given_of<Water>(m);
  state_of<Water>(s).node_pressure.resize(m.node_count);
  for_each_item(q, m.node_count,
                PoresOfNodes{.nodes = {s.nodes.motion.data()},
                             .field = w.node_field.data(),
                             .kept = w.node_kept.data(),
                             .fields = {state_of<Water>(s).fields.data()},
                             .pressure = state_of<Water>(s).node_pressure.data()});
  for_each_element_set(
      m, s, [&]<class Shape>(ElementKind<Shape>, const ElementSet& e, const ElementState&) {
        const std::size_t first = std::size_t(w.pore_row_first) + e.corner_first;
        for_each_lane(q, e.count,
                      PressInPores<Shape>{.columns = element_columns<Shape>(m, s, e),
                                          .biot = w.biot.data(),
                                          .values = e.values.data(),
                                          .pressure = state_of<Water>(s).node_pressure.data(),
                                          .out = {applied_of<Water>(s).rows.data() + 4 * first}});
      });
}

}  // namespace

std::vector<Index> Water::row_nodes(const Model& m, const cdem::State& s) {
  const WaterSet& w = given_of<Water>(m);
  std::vector<Index> node;
  for (const WetFaces* faces : {&w.triangles, &w.quads}) {
    const auto nodes = on_host(faces->nodes);
    for (Index f = 0; f < faces->count; ++f)
      for (Index k = 0; k < faces->vertices; ++k)
        node.push_back(nodes[std::size_t(k) * faces->stride + f]);
  }
  if (w.biot.size() == 0) return node;
  for_each_element_set(m, s, [&](auto, const ElementSet& e, const ElementState&) {
    const auto for_each_node = nodes_of(m, e);
    for (Index i = 0; i < e.count; ++i)
      for_each_node(i, [&](Index corner) { node.push_back(corner); });
  });
  return node;
}

void Water::act(const Model& m, cdem::State& s, Queue q) {
  const WaterSet& w = given_of<Water>(m);
  if (!is_there(w)) return;
  const PhaseTimer timer(s, Phase::element);
  evaluate_fields(m, s);
  find_wet_faces(m, s);
  press<3>(s, q, w.triangles, state_of<Water>(s).triangle_field);
  press<4>(s, q, w.quads, state_of<Water>(s).quad_field);
  if (w.biot.size() > 0) press_in_pores(m, s, q);
}

}  // namespace cdem
