// points.hpp - a few nodes with the columns that the kernels of nodes read and write.
#pragma once

#include <vector>

#include "core/nodes/central_difference.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

/// Free nodes of 1 kg at the origin, at rest, without forces.
struct Points {
  Index count;
  std::vector<Real> motion, mass, force, damping_force, unbalance, reaction, work_external,
      work_damping, step_change;
  std::vector<Index> tile_first, corner_first, corner, contact_first, contact_corner;
  std::vector<Real> tile_force, corner_force, contact_force;
  std::vector<Index> load_first, load_curve;
  std::vector<Real> load_force, curve{1.0};
  std::vector<Index> support, support_curve{0, 0, 0};
  std::vector<Flag> component{0, 0, 0}, fused;
  std::vector<Real> given{0, 0, 0};  // velocity of the support  [m/s]
  std::vector<Index> row, stride, block_first, block_count;
  std::vector<Real> inverse, matrix;
  Vec gravity{0, 0, 0};
  NodeDamping damping{0, 0};
  Real dt = 0.01, dt_before = 0.01;

  explicit Points(Index nodes)
      : count(nodes),
        motion(8 * nodes),
        mass(nodes, 1.0),
        force(4 * nodes),
        damping_force(4 * nodes),
        unbalance(nodes),
        reaction(4 * nodes),
        work_external(nodes),
        work_damping(nodes),
        step_change(nodes),
        tile_first(nodes + 1),
        corner_first(nodes + 1),
        contact_first(nodes + 1),
        load_first(nodes + 1),
        support(nodes, -1),
        row(nodes, -1),
        stride(nodes),
        block_first(nodes),
        block_count(nodes, 1) {
    for (Index i = 0; i < nodes; ++i) block_first[i] = i;
  }
  void place(Index i, const Vec& x) { put(motion.data() + 8 * i, x); }
  void move(Index i, const Vec& v) { put(motion.data() + 8 * i + 4, v); }
  Vec position_of(Index i) const { return vector_at(motion.data() + 8 * i); }
  Vec velocity_of(Index i) const { return vector_at(motion.data() + 8 * i + 4); }
  Vec force_of(Index i) const { return vector_at(force.data() + 4 * i); }
  /// Four nodes from one on become a tet with its exact mass matrix.
  void share_matrix(Index first) {
    for (Index j = 0; j < 4; ++j) {
      row[first + j] = Index(inverse.size());
      block_first[first + j] = first;
      block_count[first + j] = 4;
      for (Index k = 0; k < 4; ++k) {
        inverse.push_back(j == k ? 4 : -1);
        matrix.push_back(j == k ? 0.4 : 0.2);
      }
    }
  }

  SupportColumns supports() const {
    return {support.data(), component.data(), support_curve.data(), given.data(), curve.data()};
  }
  LoadColumns loads() const {
    return {.gravity = gravity,
            .gravity_mass = mass.data(),
            .load_first = load_first.data(),
            .load_curve = load_curve.data(),
            .load_force = load_force.data(),
            .curve_value = curve.data(),
            .relief = nullptr,
            .relief_part = 1,
            .applied = nullptr};
  }
  NodePorts ports() const {
    return {.loads = loads(),
            .has_applied = nullptr,
            .ground = nullptr,
            .corners = {.tile_first = tile_first.data(),
                        .tile_force = {tile_force.data()},
                        .first = corner_first.data(),
                        .corner = corner.data(),
                        .corner_force = {corner_force.data()},
                        .contact_first = contact_first.data(),
                        .contact_corner = contact_corner.data(),
                        .contact_force = {contact_force.data()}}};
  }
  MassColumns mass_columns() const {
    return {.lumped = false,
            .node_lumped = nullptr,
            .mass = mass.data(),
            .mass_row_first = row.data(),
            .mass_axis_stride = stride.data(),
            .block_first = block_first.data(),
            .block_count = block_count.data(),
            .inverse = inverse.data(),
            .matrix = matrix.data()};
  }
  bool damps() const { return damping.local > 0 || damping.mass > 0; }
  SumNodeForces sum_kernel() {
    return {{motion.data()}, ports(),
            supports(),      damping,
            mass_columns(),  0.5 * (dt_before + dt),
            force.data(),    damps() ? damping_force.data() : nullptr,
            unbalance.data()};
  }
  MoveNodes<> move_kernel() {
    return {mass_columns(),
            loads(),
            supports(),
            force.data(),
            damps() ? damping_force.data() : nullptr,
            dt_before,
            dt,
            motion.data(),
            reaction.data(),
            work_external.data(),
            work_damping.data(),
            dt != dt_before ? step_change.data() : nullptr};
  }
  /// Both in one pass.
  void advance() {
    const AdvanceNodes<> kernel{sum_kernel(), move_kernel(),
                                fused.empty() ? nullptr : fused.data()};
    for (Index i = 0; i < count; ++i) kernel(One{i});
  }
};

}  // namespace cdem::test
