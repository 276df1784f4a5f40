// views.hpp - the kernels' view of elements in model and state.
#pragma once

#include "core/elements/corotational.hpp"
#include "core/elements/rock_damping.hpp"
#include "core/elements/tiles.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

template <class Shape>
ElementColumns<Shape> element_columns(const Model& m, const State& s, const ElementSet& e) {
  return {.nodes = {s.nodes.motion.data()},
          .element_nodes = {e.nodes.data(), e.stride},
          .gradient = {e.gradient.data(), e.stride},
          .point_volume = {e.volume.data(), e.stride},
          .element_material = {e.material.data(), e.stride},
          .materials = {.lambda = m.material_lambda.data(),
                        .mu = m.material_mu.data(),
                        .law = m.material_law.data(),
                        .parameters = m.material_parameters.data()},
          .hourglass = {e.hourglass.data(), e.stride}};
}

/// What the damping of rock remembers of a set, which has some.
///
/// Args:
///   ahead: Is the state that of one step ago?
template <class Shape>
RockDamping<Shape> rock_damping(const Model& m, const State& s, const ElementSet& e,
                                ElementState& es, bool ahead) {
  const Real dt = s.dt_last;
  return {.branch = {es.branch.size() > 0 ? es.branch.data() : nullptr, e.stride},
          .dashpot = {es.dashpot.size() > 0 ? es.dashpot.data() : nullptr, e.stride},
          .ahead = ahead,
          .dt = dt,
          .per_step = dt > 0 ? m.damping_time / dt : 0,
          .maxwell = {m.maxwell, dt}};
}

/// Do the elements of a set remember anything for their damping?
inline bool remembers(const ElementState& es) { return es.branch.size() + es.dashpot.size() > 0; }

/// Tiles of a set.
inline Tiles tiles_of(const ElementSet& e, const ElementState& es, State& s) {
  const ElementTiles& t = es.tiles;
  return {.count = Index(t.block_first.size()) - 1,
          .block_first = t.block_first.data(),
          .node_first = t.node_first.data(),
          .node = t.node.data(),
          .row = t.row.data(),
          .place = {t.place.data(), e.stride},
          .corner_first = t.corner_first.data(),
          .corner = t.corner.data(),
          .motion = s.nodes.motion.data(),
          .force = s.tile_force.data()};
}

/// Inelastic strains of a set; empty where it has none.
template <class Shape>
PointFlow<Shape> point_flow(const State& s, const ElementSet& e, ElementState& es) {
  return {.history = {es.history.size() > 0 ? es.history.data() : nullptr, e.stride},
          .work = {es.plastic_work.size() > 0 ? es.plastic_work.data() : nullptr, e.stride},
          .dt = s.dt_last};
}

/// Call act(flow) with the inelastic strains of a set, or with NoFlow.
template <class Shape, class Act>
void with_flow(const State& s, const ElementSet& e, ElementState& es, const Act& act) {
  if (es.history.size() > 0)
    act(point_flow<Shape>(s, e, es));
  else
    act(NoFlow{});
}

}  // namespace cdem
