// views.hpp - what the kernels of nodes see of model and state.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/nodes/corner_rows.hpp"
#include "core/nodes/loads.hpp"
#include "core/nodes/mass.hpp"
#include "core/nodes/supports.hpp"

namespace cdem {

/// Lumped masses that move: those of adaptive relaxation while it lasts.
inline const Column<Real>& lumped_masses(const Model& m, const State& s) {
  return s.nodes.relax_mass.size() > 0 ? s.nodes.relax_mass : m.mass;
}

inline MassColumns mass_columns(const Model& m, const State& s) {
  return {m.lumped,
          lumped_masses(m, s).data(),
          m.mass_row_first.data(),
          m.mass_axis_stride.data(),
          m.block_first.data(),
          m.block_count.data(),
          m.mass_inverse.data(),
          m.mass_matrix.data()};
}

/// Damping forces of the last step, or null if nothing damped.
inline const Real* damping_forces(const State& s) {
  return s.nodes.damped ? s.nodes.damping_force.data() : nullptr;
}

inline SupportColumns support_columns(const Model& m, const State& s) {
  return {m.support.data(), m.support_component.data(), m.support_curve.data(),
          m.support_velocity.data(), s.velocity_factor.data()};
}

inline LoadColumns load_columns(const Model& m, const State& s) {
  return {m.gravity,           m.gravity_mass.data(), m.load_first.data(),
          m.load_curve.data(), m.load_force.data(),   s.load_factor.data()};
}

inline CornerLists corner_lists(const State& s) {
  return {s.nodes.corner_first.data(),   s.nodes.corner.data(),          {s.corner_force.data()},
          s.search.contact_first.data(), s.search.contact_corner.data(), {s.contact_force.data()}};
}

}  // namespace cdem
