// columns.hpp - the views of model and state that kernels take.
#pragma once

#include "core/contact/bond.hpp"
#include "core/contact/force.hpp"
#include "core/contact/gather.hpp"
#include "core/elements/shapes.hpp"
#include "core/model.hpp"
#include "core/nodes/motion.hpp"
#include "core/state.hpp"

namespace cdem {

inline FaceColumns face_columns(const Model& m, const State& s) {
  return {{s.nodes.motion.data()},
          m.face_nodes.data(),
          m.face_edges.data(),
          m.face_length.data(),
          m.face_height.data(),
          m.edge_nodes.data(),
          s.search.across.data(),
          s.search.ring_first.data(),
          s.search.ring.data(),
          s.nodes.glue.data(),
          m.node_place.data(),
          s.search.face_exposed.data(),
          s.dt_last};
}

inline FaceGeometry face_geometry(const State& s) {
  return {s.face_geometry.data(), s.search.exposed.data()};
}

inline Candidates candidate_columns(State& s) {
  CloseState& close = s.search.close;
  return {close.first.data(), close.candidate.data(), close.may_begin.data()};
}

inline EdgePairs edge_pairs(State& s) {
  CloseState& close = s.search.close;
  const Index count = Index(close.near_edges.size()), stride = padded_stride(count);
  const Index* rows = close.edge_pairs.data();
  return {{rows, stride},
          {rows + 4 * std::size_t(stride), stride},
          {rows + 8 * std::size_t(stride), stride},
          close.open.data()};
}

inline SpringColumns spring_columns(State& s) {
  SpringState& c = s.springs;
  return {c.target.data(),  c.target_before.data(), c.state.data(), c.friction.data(),
          c.dashpot.data(), c.reaction.data(),      c.lost.data()};
}

inline EdgeColumns edge_columns(State& s) {
  EdgeState& c = s.edges;
  return {c.first.data(), c.contact.data(), c.state.data(), c.reaction.data()};
}

inline EdgesBefore edges_before(const State& s) {
  const EdgeState& c = s.edges;
  return {c.old_first.data(), c.old_contact.data(), c.old_state.data()};
}

inline FaceSearch face_search(const Model& m, State& s) {
  return {face_columns(m, s),   face_geometry(s), s.search.exposed_face.data(),
          candidate_columns(s), m.rules,          spring_columns(s)};
}

inline FoundEdges found_edges(State& s) {
  return {s.edges.slots, s.edges.found_count.data(), s.edges.found.data(), runs_alone()};
}

inline TouchTargetEdges edge_search(const Model& m, State& s) {
  return {face_columns(m, s),  face_geometry(s), s.search.exposed_face.data(),
          edge_pairs(s),       m.rules,          edges_before(s),
          s.edges.lost.data(), found_edges(s)};
}

/// Lumped masses that move: those of adaptive relaxation while it lasts.
inline const Column<Real>& lumped_masses(const Model& m, const State& s) {
  return s.nodes.relax_mass.size() > 0 ? s.nodes.relax_mass : m.mass;
}

inline ContactLaws contact_laws(const Model& m, const State& s) {
  return {m.interface_of.data(), m.interfaces.data(), m.group_count, m.contact_damping,
          lumped_masses(m, s).data()};
}

template <class Shape>
ElementColumns<Shape> element_columns(const Model& m, const State& s, const ElementSet& e) {
  return {{s.nodes.motion.data()},       {e.nodes.data(), e.stride},
          {e.gradient.data(), e.stride}, {e.volume.data(), e.stride},
          {e.material.data(), e.stride}, {m.material_lambda.data(), m.material_mu.data()},
          {e.hourglass.data(), e.stride}};
}

inline PairColumns pair_columns(const Model& m, const PairSet& p, PairState& s) {
  const auto in = [&](const Column<Real>& c) { return InTable{c.data(), p.stride}; };
  const auto inout = [&](Column<Real>& c) { return InOutTable{c.data(), p.stride}; };
  const auto point = [&](Column<Real>& c) { return InOutTable{c.data(), p.point_stride}; };
  return {{p.interface.data(), p.stride},
          in(p.area),
          in(s.live),
          in(p.stiffness),
          m.cohesion.data(),
          m.tensile_strength.data(),
          m.tan_friction.data(),
          point(s.bond),
          point(s.slip1),
          point(s.slip2),
          inout(s.broken_tension),
          inout(s.broken_shear),
          inout(s.jump),
          inout(s.jump_at_break),
          inout(s.stored),
          inout(s.fracture),
          inout(s.friction)};
}

inline MassColumns mass_columns(const Model& m, const State& s) {
  return {m.lumped,
          lumped_masses(m, s).data(),
          m.dense_first.data(),
          m.dense_step.data(),
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
