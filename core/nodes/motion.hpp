// motion.hpp - from corner forces to motion: sum, damping, supports, central differences.
#pragma once

#include "core/contact/face.hpp"

namespace cdem {

/// Loads on nodes: gravity, and forces that follow curves of time.
struct LoadColumns {
  Vec3<Real> gravity;        // [m/s2]
  const Real* gravity_mass;  // [node] mass that gravity acts on  [kg]
  const Index* load_first;   // [node + 1]
  const Index* load_curve;   // curve that scales the load
  const Real* load_force;    // row of 4  [N]
  const Real* curve_value;   // [curve] factors at the time of this step

  CDEM_HD Row at(Index node) const {
    Row f = gravity_mass[node] * Row::of(gravity.x, gravity.y, gravity.z);
    for (Index l = load_first[node]; l < load_first[node + 1]; ++l)
      f = f + curve_value[load_curve[l]] * Row::at(load_force + std::size_t(l) * 4);
    return f;
  }
};

/// Supports: components of a node whose velocity is given (zero for a fixed one).
struct SupportColumns {
  const Index* support;        // [node]: row below, or -1
  const Flag* component;       // [support][3]: 1 where the velocity is given
  const Index* curve;          // [support][3]: curve that scales it
  const Real* velocity;        // [support][3]  [m/s]
  const Real* curve_velocity;  // [curve] factors at the middle of the coming step

  CDEM_HD bool given(Index node, Index axis) const {
    return support[node] >= 0 && component[3 * support[node] + axis];
  }
  CDEM_HD Real at(Index node, Index axis) const {
    const Index row = 3 * support[node] + axis;
    return velocity[row] * curve_velocity[curve[row]];
  }
  /// A row of the node with the given components put in, or with zeros in their places.
  CDEM_HD Row with_given(Index node, const Row& free) const {
    if (support[node] < 0) return free;
    const auto part = [&](Index axis) { return given(node, axis) ? at(node, axis) : free.n[axis]; };
    return Row::of(part(0), part(1), part(2));
  }
  CDEM_HD Row without_given(Index node, const Row& row) const {
    if (support[node] < 0) return row;
    const auto part = [&](Index axis) { return given(node, axis) ? 0.0 : row.n[axis]; };
    return Row::of(part(0), part(1), part(2));
  }
};

/// Which corner rows belong to a node.
struct CornerLists {
  const Index* first;   // [node + 1], rows of elements and bonded pairs
  const Index* corner;  // ~row where the node takes the opposite of what stands there
  InForces corner_force;
  const Index* contact_first;  // [node + 1], rows of exposed faces that may have contacts
  const Index* contact_corner;
  InForces contact_force;  // rows: force, stiffness

  /// Sum of a node's rows, in the order of its list: those of elements come first, and have no
  /// sign.
  CDEM_HD Row sum(Index node, Row f) const {
    Index c = first[node];
    const Index last = first[node + 1];
    for (; c < last && corner[c] >= 0; ++c) f = f + corner_force.at(corner[c]);
    for (; c < last; ++c) f = f + corner_force.signed_row(corner[c]);
    return f;
  }
};

/// Mass of the nodes: a number each, or for small blocks the inverse of the consistent mass matrix,
/// which gives them their exact inertia. Matrices are kept without the mass, so that all tets share
/// one.
struct MassColumns {
  bool lumped;               // only the numbers count, whatever the matrices
  const Real* mass;          // [node] row sum of the mass matrix  [kg]
  const Index* dense_first;  // [node]: start of the node's row in `dense`, or -1 when lumped
  const Index* dense_step;   // [node]: from one axis to the next (0 when all three share)
  const Index* block_first;  // [node]: first node of the block
  const Index* block_count;  // [node]: nodes of the block
  const Real* inverse;       // rows of the inverse times `mass`, supported nodes taken out
  const Real* matrix;        // rows of the matrix over `mass`, in the same places

  /// Start of a node's row in `inverse` and `matrix`, or -1 when its mass is lumped.
  CDEM_HD Index row(Index node) const { return lumped ? -1 : dense_first[node]; }
  /// Is a node of the block supported, so that the inverse differs from axis to axis?
  CDEM_HD bool held(Index node) const { return row(node) >= 0 && dense_step[node] > 0; }
  /// Part of M a of a node that the given motion of supported nodes of its block makes, row by row
  /// of the full matrix  [N].
  CDEM_HD Row given_inertia(const SupportColumns& supports, const InMotion& nodes, Index i,
                            Real kick) const {
    Vec3<Real> sum{0.0, 0.0, 0.0};
    const Index start = row(i);
    for (Index j = 0; j < block_count[i]; ++j) {
      const Index other = block_first[i] + j;
      if (supports.support[other] < 0) continue;
      const Real m = mass[i] * matrix[start + j] / kick;
      const Vec3<Real> v = nodes.velocity(other);
      if (supports.given(other, 0)) sum.x += m * (supports.at(other, 0) - v.x);
      if (supports.given(other, 1)) sum.y += m * (supports.at(other, 1) - v.y);
      if (supports.given(other, 2)) sum.z += m * (supports.at(other, 2) - v.z);
    }
    return Row::of(sum.x, sum.y, sum.z);
  }
  /// Momentum M v of a node  [kg m/s].
  CDEM_HD Row momentum(const InMotion& nodes, Index i) const {
    const Index start = row(i);
    if (start < 0) return mass[i] * nodes.velocity_row(i);
    Row p = Row::zero();
    for (Index j = 0; j < block_count[i]; ++j)
      p = p + matrix[start + j] * nodes.velocity_row(block_first[i] + j);
    return mass[i] * p;
  }
};

/// Damping of the nodes' motion.
struct NodeDamping {
  Real local;  // Cundall's, fraction of the unbalanced force, against the velocity
  Real mass;   // mass-proportional  [1/s]
};

/// Sum the forces on each node in a fixed order, and add the damping force.
struct SumNodeForces {
  InMotion nodes;
  CornerLists corners;
  LoadColumns loads;
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
    Row f = corners.sum(i, loads.at(i));
    for (Index c = corners.contact_first[i]; c < corners.contact_first[i + 1]; ++c)
      f = f + corners.contact_force.at(corners.contact_corner[c]);
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
/// kinetic energy, central differences keep the sum of all energies exactly when forces are linear.
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

  CDEM_HD void operator()(One node) const {
    const Index i = node.i;
    Real* r = motion + std::size_t(i) * 8;
    const Row v0 = Row::at(r + 4);
    const Real kick = 0.5 * (dt_before + dt);
    const Row v1 = supports.with_given(i, v0 + kick * acceleration(i));
    v1.store(r + 4);
    (Row::at(r) + dt * v1).store(r);
    const Row way = 0.5 * (dt_before * v0 + dt * v1);
    Row external = loads.at(i);
    if (supports.support[i] >= 0) external = external + react(i, v0, v1);
    work_external[i] += dot(external.vector(), way.vector());
    if (damping_force)
      work_damping[i] -= dot(Row::at(damping_force + std::size_t(i) * 4).vector(), way.vector());
  }

 private:
  CDEM_HD Row acceleration(Index i) const {
    const Index row = mass.row(i);
    if (row < 0) return (Row::at(force + std::size_t(i) * 4) / mass.mass[i]).xyz();
    const Index count = mass.block_count[i];
    const Real *inverse = mass.inverse + row,
               *forces = force + std::size_t(mass.block_first[i]) * 4;
    Row a = Row::zero();
    if (mass.held(i)) {  // another matrix for each axis
      const Real *x = inverse, *y = x + mass.dense_step[i], *z = y + mass.dense_step[i];
      for (Index j = 0; j < count; ++j, forces += 4)
        a = a + Row::of(x[j] * forces[0], y[j] * forces[1], z[j] * forces[2]);
    } else {
      for (Index j = 0; j < count; ++j, forces += 4) a = a + inverse[j] * Row::at(forces);
    }
    return (a / mass.mass[i]).xyz();
  }
  /// Force of the support: what is missing for the motion that it imposed. With a full mass matrix
  /// `force` has the inertia of all given motions of the block already.
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

/// Both at once, for a step in which nothing looks at the forces in between: what the sum leaves is
/// still in cache when the motion wants it. Nodes that share a mass matrix go together, with the
/// first of them.
struct AdvanceNodes {
  SumNodeForces sum;
  MoveNodes move;
  const Flag* free;  // [node] 1: moved by AdvanceFree; null where none is

  CDEM_HD void operator()(One node) const {
    const Index i = node.i;
    if (free && free[i]) return;
    const bool shared = move.mass.row(i) >= 0;
    if (shared && move.mass.block_first[i] != i) return;
    const Index last = shared ? i + move.mass.block_count[i] : i + 1;
    for (Index j = i; j < last; ++j) sum(One{j});
    for (Index j = i; j < last; ++j) move(One{j});
  }
};

/// Momentum M v of each node before the step: half of what the kinetic energy needs. Kept in the
/// rows of `SampleNodes` until that has the other half.
struct NodeMomentum {
  InMotion nodes;
  MassColumns mass;
  Real* momentum;  // row of 4  [kg m/s]

  CDEM_HD void operator()(One node) const {
    mass.momentum(nodes, node.i).store(momentum + std::size_t(node.i) * 4);
  }
};

/// Energy of the nodes at the time of the forces; runs after the motion.
struct SampleNodes {
  InMotion nodes;  // velocity: after
  LoadColumns loads;
  SupportColumns supports;
  const Real* reaction;
  const Real* damping_force;  // null where nothing damps
  Real dt;
  Real* sample;  // row of 4, comes with M v before; kinetic energy; the external and the damping
                 // work of the half step that follows, which the sums contain already  [J]

  CDEM_HD void operator()(One node) const {
    const Index i = node.i;
    const Vec3<Real> v1 = nodes.velocity(i);
    Row external = loads.at(i);
    if (supports.support[i] >= 0) external = external + Row::at(reaction + std::size_t(i) * 4);
    Real* r = sample + std::size_t(i) * 4;
    r[0] = 0.5 * dot(Row::at(r).vector(), v1);
    r[1] = 0.5 * dt * dot(external.vector(), v1);
    r[2] = damping_force ? -0.5 * dt * dot(Row::at(damping_force + std::size_t(i) * 4).vector(), v1)
                         : 0;
  }
};

}  // namespace cdem
