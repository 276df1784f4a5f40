// init_state.cpp - see init_state.hpp.
#include "core/model/init_state.hpp"

#include <algorithm>

#include "core/interfaces/laws.hpp"
#include "core/materials/laws.hpp"
#include "core/model/applied_lists.hpp"
#include "core/model/element_corners.hpp"
#include "core/model/force_sets.hpp"
#include "core/model/tiles.hpp"

namespace cdem {

namespace {

bool has_flowing_element(const Model& m, const ElementSet& e) {
  const auto material = on_host(e.material), law = on_host(m.material_law);
  bool any = false;
  BlockLaws::for_each([&]<template <class> class Law, Index number>() {
    for (Index i = 0; i < e.count; ++i)
      any = any || (Law<Real>::inelastic && law[material[i]] == number);
  });
  return any;
}

void size(const Model& m, const ElementSet& e, ElementState& es) {
  const std::size_t row = e.stride;
  es.stress.resize(6 * row);
  es.energy.resize(row);
  es.damping_work.resize(row);
  const bool keeps_stress =
      m.formulation == Formulation::incremental || m.formulation == Formulation::paper_incremental;
  const bool flows = has_flowing_element(m, e);
  if (flows || m.initial_stress) es.history.resize(std::size_t(point_history * e.points) * row);
  if (flows) es.plastic_work.resize(row);
  if (flows) es.yielded.resize(row);
  if (keeps_stress) es.point_stress.resize(6 * std::size_t(e.points) * row);
}

void init_histories(const Model& m, const PairSet& p, PairState& s) {
  if (!m.interface_traits.has_state) return;
  s.history_width = InterfaceLaws::most_state;
  s.history.resize(s.history_width * std::size_t(p.points) * p.point_stride);
  const BeginHistory begin(m, p, s);
  const auto first = on_host(p.point_first);
  for (Index i = 0; i < p.count; ++i)
    if (!conforms(p))
      for (Index c = first[i]; c < first[i + 1]; ++c) begin(i, c);
    else
      for (Index k = 0; k < p.points; ++k) begin(i, std::size_t(k) * p.point_stride + i);
}

void size(const Model& m, const PairSet& p, PairState& s) {
  const std::size_t row = p.stride, points = std::size_t(p.points) * p.point_stride;
  for (Column<Real>* column :
       {&s.broken_tension, &s.broken_shear, &s.jump, &s.stored, &s.fracture, &s.friction})
    column->resize(row);
  s.jump_at_break.resize(row, -1.0);
  s.status.resize(row);
  const auto status = on_host(s.status);
  std::fill_n(status.begin(), p.count, Flag(PairStatus::bonded));
  s.bond.resize(points, 1.0);
  s.slip1.resize(points);
  s.slip2.resize(points);
  if (m.loose_pairs) s.rest.resize(3 * points);
  init_histories(m, p, s);
}

template <ModuleData Given>
void size(const Model&, const Given& given, auto& state) {
  Given::Module::size(given, state);
}

}  // namespace

BeginHistory::BeginHistory(const Model& m, const PairSet& p, PairState& s)
    : interfaces_(on_host(m.interfaces)),
      interface_(on_host(p.interface)),
      history_(on_host(s.history)),
      points_(std::size_t(p.points) * p.point_stride) {}

void BeginHistory::operator()(Index pair, std::size_t point) const {
  if (history_.size() == 0) return;
  InterfaceLaws::for_each([&]<template <class> class Law, Index number>() {
    if (interfaces_[interface_[pair]].law != number) return;
    for (Index k = 0; k < state_count<Law>; ++k)
      history_[k * points_ + point] = Law<Real>::state[k].intact;
  });
}

void make_room_for_rises(const Model& m, State& s) {
  if (!(m.rules.lifted > m.initial_lift)) return;  // no interface dilates
  for (PairState* pairs : {&s.triangles, &s.quads, &s.overlaps})
    pairs->rise.resize(pairs->bond.size());
}

void init_state(const Model& m, State& s, const Real* position) {
  const std::size_t count = m.node_count;
  NodeState& n = s.nodes;
  n.motion.resize(8 * count);
  const auto motion = on_host(n.motion);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) motion[8 * i + axis] = position[3 * i + axis];
  for (Column<Real>* column : {&n.force, &n.reaction, &n.sample}) column->resize(4 * count);
  for (Column<Real>* column : {&n.work_external, &n.work_damping, &n.step_change, &n.unbalance})
    column->resize(count);
  n.bonded_node.resize(count);
  n.body.resize(count);
  for (HistoryColumns* history :
       {&s.springs.history, &s.edges.side_history, &s.edges.contact_history})
    history->width = m.interface_traits.has_state ? InterfaceLaws::most_state : 0;
  for_each_set(m, s, [&](auto, const auto& set, auto& state) { size(m, set, state); });
  make_room_for_rises(m, s);
  list_tiles(m, s);
  list_element_corners(m, s);
  list_applied(m, s);
  Modules::for_each_of<Port::applied>([&]<class Module>() {
    if constexpr (requires { Module::start(m, s); })
      if (Module::is_there(given_of<Module>(m))) Module::start(m, s);
  });
  const std::size_t rows = 4 * std::size_t(m.corner_rows);
  s.corner_force.resize(rows + 4);
  // the row that adds nothing, see FusedRows: x + -0 is x, whatever the sign of a zero
  std::fill_n(on_host(s.corner_force).begin() + rows, 4, -0.0);
}

}  // namespace cdem
