// views.hpp - the kernels' view of bonds in model and state.
#pragma once

#include "core/bonds/bonded_pairs.hpp"
#include "core/bonds/broken_pairs.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/model/interface_table.hpp"
#include "core/model/state.hpp"

namespace cdem {

inline PairColumns pair_columns(const Model& m, const PairSet& p, PairState& s) {
  const auto in = [&](const Column<Real>& c) { return InTable{c.data(), p.stride}; };
  const auto inout = [&](Column<Real>& c) { return InOutTable{c.data(), p.stride}; };
  const auto point = [&](Column<Real>& c) { return InOutTable{c.data(), p.point_stride}; };
  return {.interface = {p.interface.data(), p.stride},
          .area = in(p.area),
          .status = {s.status.data()},
          .stiffness = in(p.stiffness),
          .strength = {p.strength.size() > 0 ? p.strength.data() : nullptr, p.stride},
          .interfaces = interface_table(m),
          .bond = point(s.bond),
          .slip1 = point(s.slip1),
          .slip2 = point(s.slip2),
          .rest = {s.rest.size() > 0 ? s.rest.data() : nullptr, p.point_stride},
          .rise = {s.rise.size() > 0 ? s.rise.data() : nullptr, p.point_stride},
          .history = point(s.history),
          .broken_tension = inout(s.broken_tension),
          .broken_shear = inout(s.broken_shear),
          .jump = inout(s.jump),
          .jump_at_break = inout(s.jump_at_break),
          .stored = inout(s.stored),
          .fracture = inout(s.fracture),
          .friction = inout(s.friction)};
}

/// Forces on the corner rows of a set.
inline OutForces corner_forces(State& s, const PairSet& p) {
  return {s.corner_force.data() + std::size_t(p.corner_first) * 4};
}

inline PairLengths pair_lengths(const Model& m, const PairSet& p) {
  return {p.faces.data(), m.face_length.data()};
}

/// Bonds of conforming pairs as they are, without the forces of a step.
template <Index count>
ConformingBonds<count> conforming_bonds(const Model& m, State& s, const PairSet& p, PairState& ps) {
  return {.nodes = {s.nodes.motion.data()},
          .pair_nodes = {p.nodes.data(), p.stride},
          .pairs = pair_columns(m, p, ps),
          .indentation = count == 3 ? m.bond_indentation_triangle : m.bond_indentation_quad,
          .dt = 0,
          .sampled = false,
          .corner_force = {}};
}

inline OverlapBonds overlap_bonds(const Model& m, State& s) {
  const PairSet& p = m.overlaps;
  return {.faces = face_columns(m, s),
          .pair_faces = p.faces.data(),
          .point_first = p.point_first.data(),
          .weights_a = p.weights_a.data(),
          .weights_b = p.weights_b.data(),
          .point_area = p.point_area.data(),
          .pairs = pair_columns(m, p, s.overlaps),
          .corner_force = corner_forces(s, p)};
}

}  // namespace cdem
