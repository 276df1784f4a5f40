// central_difference.hpp - from corner forces to motion: sum, damping, supports, central
// differences.
#pragma once

#include "core/nodes/dashpots.hpp"
#include "core/nodes/mass.hpp"
#include "core/nodes/ports.hpp"
#include "core/nodes/supports.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// Sum the forces on each node in a fixed order, and add the damping force.
struct SumNodeForces {
  InMotion nodes;
  NodePorts ports;
  SupportColumns supports;
  NodeDamping damping;
  MassColumns mass;
  Real kick;            // time over which the force acts in the coming step  [s]
  Real* force;          // row of 4: x y z, less given_inertia [N], stiffness of the contacts [N/m]
  Real* damping_force;  // row of 4  [N]; null where nothing damps
  Real* unbalance;      // [node] |x| + |y| + |z| of the unbalanced force on free components  [N];
                        // null where nothing asks for it

  CDEM_HD void operator()(One node) const {
    const Index i = node.i;
    Row f = ports.sum(i);
    if (unbalance) {
      const Row free = supports.without_given(i, f);
      unbalance[i] = abs_of(free.n[0]) + abs_of(free.n[1]) + abs_of(free.n[2]);
    }
    if (damping_force) {
      // where a support prescribes the motion there is nothing to damp
      const Row d = supports.without_given(i, drag(i, f));
      d.store(damping_force + std::size_t(i) * 4);
      f = f + d;
    }
    if (mass.held(i)) f = f - mass.given_inertia(supports, nodes, i, kick);
    f.store(force + std::size_t(i) * 4);
  }

 private:
  /// Damping force on a node that is free to move.
  CDEM_HD Row drag(Index i, const Row& f) const {
    Row d = Row::zero();
    if (damping.local > 0) {
      const Row v = nodes.velocity_row(i);
      const auto against = [&](Index axis) {
        const Real size = damping.local * abs_of(f.n[axis]);
        return v.n[axis] > 0 ? -size : (v.n[axis] < 0 ? size : 0.0);
      };
      d = Row::of(against(0), against(1), against(2));
    }
    if (damping.mass > 0) d = d - damping.mass * mass.momentum(nodes, i);
    return d;
  }
};

/// Advance velocity and position by one step of central differences, and account for the work.
///
/// The force of time n acts from the middle of the step before to the middle of this one, with the
/// mean of the velocities before and after it. Counted so, and with 1/2 v_before . M v_after as
/// kinetic energy, central differences keep the sum of all energies exactly when forces are linear
/// and the step does not change. A change of the step takes 1/4 (dt - dt_before) f . (v_after -
/// v_before) from that sum, see SampleNodes: the rest is exact again.
template <class Dashing = NoDashpots>
struct MoveNodes {
  MassColumns mass;
  LoadColumns loads;
  SupportColumns supports;
  const Real* force;          // row of 4  [N]
  const Real* damping_force;  // row of 4  [N]; null where nothing damps
  Real dt_before, dt;         // of the last step and of this one  [s]
  Real* motion;               // row of 8
  Real* reaction;             // row of 4: force of the support  [N]
  Real* work_external;        // [node] of loads, gravity and supports so far  [J]
  Real* work_damping;         // [node] taken out by damping so far  [J]
  Real* step_change;          // [node] hidden by changes of the step so far  [J]; null where this
                              // step is as long as the last one
  Dashing ground{};

  CDEM_HD void operator()(One node) const {
    const Index i = node.i;
    Real* r = motion + std::size_t(i) * 8;
    const Row v0 = Row::at(r + 4);
    const Real kick = 0.5 * (dt_before + dt);
    const Row v1 = supports.with_given(i, v0 + change(i, v0, kick));
    v1.store(r + 4);
    (Row::at(r) + dt * v1).store(r);
    const Row displacement = 0.5 * (dt_before * v0 + dt * v1);
    Row external = loads.at(i), support = Row::zero();
    if (supports.support[i] >= 0) support = react(i, v0, v1);
    external = external + support;
    work_external[i] += dot(external.vector(), displacement.vector());
    if (damping_force)
      work_damping[i] -=
          dot(Row::at(damping_force + std::size_t(i) * 4).vector(), displacement.vector());
    if constexpr (Dashing::any)
      if (ground.act_on(i)) {
        const Row drag = ground.force_on(i);
        ground.radiated[i] -= dot(drag.vector(), displacement.vector());
        support = support + drag;
      }
    if (step_change) {
      const Row acting = Row::at(force + std::size_t(i) * 4) + support;
      step_change[i] += 0.25 * (dt - dt_before) * dot(acting.vector(), (v1 - v0).vector());
    }
  }

 private:
  CDEM_HD Row change(Index i, const Row& v0, Real kick) const {
    if constexpr (Dashing::any)
      if (ground.act_on(i))
        return ground.change(i, supports, Row::at(force + std::size_t(i) * 4), v0,
                             mass.mass[i] / kick);
    return kick * acceleration(i);
  }
  CDEM_HD Row acceleration(Index i) const {
    const Index row = mass.row(i);
    if (row < 0) return (Row::at(force + std::size_t(i) * 4) / mass.mass[i]).xyz();
    const Index count = mass.block_count[i];
    const Real *inverse = mass.inverse + row,
               *forces = force + std::size_t(mass.block_first[i]) * 4;
    Row a = Row::zero();
    if (mass.held(i)) {  // another matrix for each axis
      const Real *x = inverse, *y = x + mass.mass_axis_stride[i], *z = y + mass.mass_axis_stride[i];
      for (Index j = 0; j < count; ++j, forces += 4)
        a = a + Row::of(x[j] * forces[0], y[j] * forces[1], z[j] * forces[2]);
    } else {
      for (Index j = 0; j < count; ++j, forces += 4) a = a + inverse[j] * Row::at(forces);
    }
    return (a / mass.mass[i]).xyz();
  }
  /// Force of the support: the difference to the force of its imposed motion. With a full mass
  /// matrix `force` has the inertia of all given motions of the block already.
  CDEM_HD Row react(Index i, const Row& v0, const Row& v1) const {
    Row need = mass.mass[i] * ((2.0 / (dt_before + dt)) * (v1 - v0));
    const Index row = mass.row(i);
    if (row >= 0) {
      need = Row::zero();
      for (Index j = 0; j < mass.block_count[i]; ++j) {
        const Index other = mass.block_first[i] + j;
        const Row a = acceleration(other);
        for (Index axis = 0; axis < 3; ++axis)
          if (other != i && !supports.given(other, axis))
            need.n[axis] += mass.matrix[row + j] * a.n[axis];
      }
      need = mass.mass[i] * need;
    }
    Row r = Row::zero();
    for (Index axis = 0; axis < 3; ++axis)
      if (supports.given(i, axis)) r.n[axis] = need.n[axis] - force[std::size_t(i) * 4 + axis];
    r.store(reaction + std::size_t(i) * 4);
    return r;
  }
};

/// Both at once, for a step that needs no forces in between: the sum is still in cache for
/// the motion. Nodes that share a mass matrix go together, with the
/// first of them.
template <class Dashing = NoDashpots>
struct AdvanceNodes {
  SumNodeForces sum;
  MoveNodes<Dashing> move;
  const Flag* fused;  // [node] 1: moved by AdvanceFused; null where none is

  CDEM_HD void operator()(One node) const {
    const Index i = node.i;
    if (fused && fused[i]) return;
    const bool shared = move.mass.row(i) >= 0;
    if (shared && move.mass.block_first[i] != i) return;
    const Index last = shared ? i + move.mass.block_count[i] : i + 1;
    for (Index j = i; j < last; ++j) sum(One{j});
    for (Index j = i; j < last; ++j) move(One{j});
  }
};

}  // namespace cdem
