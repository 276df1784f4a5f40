// views.hpp - the kernels' view of nodes in model and state.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/nodes/dashpots.hpp"
#include "core/nodes/mass.hpp"
#include "core/nodes/ports.hpp"
#include "core/nodes/supports.hpp"

namespace cdem {

/// Lumped masses that move: scaled ones during adaptive relaxation.
inline const Column<Real>& lumped_masses(const Model& m, const State& s) {
  return s.nodes.relax_mass.size() > 0 ? s.nodes.relax_mass : m.mass;
}

inline MassColumns mass_columns(const Model& m, const State& s) {
  return {.lumped = m.lumped,
          .node_lumped = s.nodes.lumped.size() > 0 ? s.nodes.lumped.data() : nullptr,
          .mass = lumped_masses(m, s).data(),
          .mass_row_first = m.mass_row_first.data(),
          .mass_axis_stride = m.mass_axis_stride.data(),
          .block_first = m.block_first.data(),
          .block_count = m.block_count.data(),
          .inverse = m.mass_inverse.data(),
          .matrix = m.mass_matrix.data()};
}

/// Damping forces of the last step, or null if nothing damped.
inline const Real* damping_forces(const State& s) {
  return s.nodes.damped ? s.nodes.damping_force.data() : nullptr;
}

inline SupportColumns support_columns(const Model& m, const State& s) {
  return {.support = m.support.data(),
          .component = m.support_component.data(),
          .curve = m.support_curve.data(),
          .velocity = m.support_velocity.data(),
          .curve_velocity = s.velocity_factor.data()};
}

/// Sum of forces of modules, rows of 4; null: none.
inline const Real* applied_forces(const State& s) {
  if (s.nodes.applied.size() > 0) return s.nodes.applied.data();
  const Real* sum = nullptr;
  Modules::for_each_of<Port::applied>([&]<class Module>() {
    if (applied_of<Module>(s).sum.size() > 0) sum = applied_of<Module>(s).sum.data();
  });
  return sum;
}

inline LoadColumns load_columns(const Model& m, const State& s) {
  return {.gravity = m.gravity,
          .gravity_mass = m.gravity_mass.data(),
          .load_first = m.load_first.data(),
          .load_curve = m.load_curve.data(),
          .load_force = m.load_force.data(),
          .curve_value = s.load_factor.data(),
          .relief = s.nodes.relief.size() > 0 ? s.nodes.relief.data() : nullptr,
          .relief_part = s.relief.part,
          .applied = applied_forces(s)};
}

inline CornerLists corner_lists(const State& s) {
  return {.tile_first = s.nodes.tile_first.data(),
          .tile_force = {s.tile_force.data()},
          .first = s.nodes.corner_first.data(),
          .corner = s.nodes.corner.data(),
          .corner_force = {s.corner_force.data()},
          .contact_first = s.search.contact_first.data(),
          .contact_corner = s.search.contact_corner.data(),
          .contact_force = {s.contact_force.data()}};
}

inline Dashpots dashpots(State& s) {
  return {.row = s.ground.row.data(),
          .matrix = s.ground.matrix.data(),
          .force = s.ground.force.data(),
          .radiated = s.nodes.radiated.data()};
}

inline NodePorts node_ports(const Model& m, const State& s) {
  return {.loads = load_columns(m, s),
          .has_applied = s.nodes.has_applied.size() > 0 ? s.nodes.has_applied.data() : nullptr,
          .ground = s.ground.row.size() > 0 ? s.ground.row.data() : nullptr,
          .corners = corner_lists(s)};
}

}  // namespace cdem
