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

  CDEM_HD Vec3<Real> at(Index node) const {
    Vec3<Real> f = gravity_mass[node] * gravity;
    for (Index l = load_first[node]; l < load_first[node + 1]; ++l) {
      const Real factor = curve_value[load_curve[l]];
      const Real* r = load_force + std::size_t(l) * 4;
      f = f + factor * Vec3<Real>{r[0], r[1], r[2]};
    }
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
};

/// Which corner rows belong to a node.
struct CornerLists {
  const Index* first;  // [node + 1], rows of elements and bonded pairs
  const Index* corner;
  InForces corner_force;
  const Index* contact_first;  // [node + 1], rows of exposed faces
  const Index* contact_corner;
  const Real* contact_force;  // row of 4: force, stiffness
};

/// Mass of the nodes: a number each, or for small blocks the inverse of the consistent mass matrix,
/// which gives them their exact inertia.
struct MassColumns {
  bool lumped;               // only the numbers count, whatever the matrices
  const Real* mass;          // [node] row sum of the mass matrix  [kg]
  const Index* dense_first;  // [node]: start of the node's row in `dense`, or -1 when lumped
  const Index* dense_step;   // [node]: from one axis to the next (0 when all three share)
  const Index* block_first;  // [node]: first node of the block
  const Index* block_count;  // [node]: nodes of the block
  const Real* inverse;       // rows of the inverse, supported nodes taken out  [1/kg]
  const Real* matrix;        // rows of the matrix, in the same places  [kg]

  /// Start of a node's row in `inverse` and `matrix`, or -1 when its mass is lumped.
  CDEM_HD Index row(Index node) const { return lumped ? -1 : dense_first[node]; }
  /// Part of M a of a node that the given motion of supported nodes of its block makes, row by row
  /// of the full matrix; nothing where masses are lumped  [N].
  CDEM_HD Vec3<Real> given_inertia(const SupportColumns& supports, const InMotion& nodes, Index i,
                                   Real kick) const {
    Vec3<Real> sum{0.0, 0.0, 0.0};
    const Index start = row(i);
    if (start < 0) return sum;
    for (Index j = 0; j < block_count[i]; ++j) {
      const Index other = block_first[i] + j;
      if (supports.support[other] < 0) continue;
      const Real m = matrix[start + j] / kick;
      const Vec3<Real> v = nodes.velocity(other);
      if (supports.given(other, 0)) sum.x += m * (supports.at(other, 0) - v.x);
      if (supports.given(other, 1)) sum.y += m * (supports.at(other, 1) - v.y);
      if (supports.given(other, 2)) sum.z += m * (supports.at(other, 2) - v.z);
    }
    return sum;
  }
  /// Momentum M v of a node  [kg m/s].
  CDEM_HD Vec3<Real> momentum(const InMotion& nodes, Index i) const {
    const Index start = row(i);
    if (start < 0) return mass[i] * nodes.velocity(i);
    Vec3<Real> p{0.0, 0.0, 0.0};
    for (Index j = 0; j < block_count[i]; ++j)
      p = p + matrix[start + j] * nodes.velocity(block_first[i] + j);
    return p;
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
  Real* damping_force;  // row of 4  [N]
  Real* unbalance;      // [node] |x| + |y| + |z| of the unbalanced force on free components  [N]

  CDEM_HD void operator()(One node) const {
    const Index i = node.i;
    Vec3<Real> f = loads.at(i);
    for (Index c = corners.first[i]; c < corners.first[i + 1]; ++c)
      f = f + corners.corner_force.at(corners.corner[c]);
    Real stiffness = 0;
    for (Index c = corners.contact_first[i]; c < corners.contact_first[i + 1]; ++c) {
      const Real* r = corners.contact_force + std::size_t(corners.contact_corner[c]) * 4;
      f = f + Vec3<Real>{r[0], r[1], r[2]};
      stiffness += r[3];
    }
    const Vec3<Real> v = nodes.velocity(i);
    Vec3<Real> p{0.0, 0.0, 0.0};
    if (damping.mass > 0) p = mass.momentum(nodes, i);
    const Vec3<Real> d{drag(i, 0, f.x, v.x, p.x), drag(i, 1, f.y, v.y, p.y),
                       drag(i, 2, f.z, v.z, p.z)};
    unbalance[i] = free(i, 0, f.x) + free(i, 1, f.y) + free(i, 2, f.z);
    Real* r = force + std::size_t(i) * 4;
    const Vec3<Real> net = f + d - mass.given_inertia(supports, nodes, i, kick);
    r[0] = net.x, r[1] = net.y, r[2] = net.z, r[3] = stiffness;
    Real* q = damping_force + std::size_t(i) * 4;
    q[0] = d.x, q[1] = d.y, q[2] = d.z;
  }

 private:
  /// Damping of one component. Where a support prescribes the motion there is nothing to damp: it
  /// would only add to the support's force.
  CDEM_HD Real drag(Index node, Index axis, Real f, Real v, Real momentum) const {
    if (supports.given(node, axis)) return 0.0;
    const Real size = damping.local * abs_of(f);
    return (v > 0 ? -size : (v < 0 ? size : 0.0)) - damping.mass * momentum;
  }
  CDEM_HD Real free(Index node, Index axis, Real f) const {
    return supports.given(node, axis) ? 0.0 : abs_of(f);
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
  const Real* damping_force;  // row of 4  [N]
  Real dt_before, dt;         // of the last step and of this one  [s]
  Real* motion;               // row of 8
  Real* reaction;             // row of 4: force of the support  [N]
  Real* work_external;        // [node] of loads, gravity and supports so far  [J]
  Real* work_damping;         // [node] taken out by damping so far  [J]

  CDEM_HD void operator()(One node) const {
    const Index i = node.i;
    Real a[3];
    acceleration(i, a);
    Real* r = motion + std::size_t(i) * 8;
    const Vec3<Real> v0{r[4], r[5], r[6]};
    const Real kick = 0.5 * (dt_before + dt);
    for (Index axis = 0; axis < 3; ++axis) {
      r[4 + axis] = supports.given(i, axis) ? supports.at(i, axis) : r[4 + axis] + kick * a[axis];
      r[axis] += dt * r[4 + axis];
    }
    const Vec3<Real> v1{r[4], r[5], r[6]}, way = 0.5 * (dt_before * v0 + dt * v1);
    Vec3<Real> external = loads.at(i);
    if (supports.support[i] >= 0) external = external + react(i, v0, v1);
    const Real* d = damping_force + std::size_t(i) * 4;
    work_external[i] += dot(external, way);
    work_damping[i] -= dot(Vec3<Real>{d[0], d[1], d[2]}, way);
  }

 private:
  CDEM_HD void acceleration(Index i, Real* a) const {
    const Index row = mass.row(i);
    if (row < 0) {
      for (Index axis = 0; axis < 3; ++axis)
        a[axis] = force[std::size_t(i) * 4 + axis] / mass.mass[i];
      return;
    }
    const Index first = mass.block_first[i], count = mass.block_count[i];
    for (Index axis = 0; axis < 3; ++axis) {
      const Real* inverse = mass.inverse + row + axis * mass.dense_step[i];
      a[axis] = 0;
      for (Index j = 0; j < count; ++j)
        a[axis] += inverse[j] * force[std::size_t(first + j) * 4 + axis];
    }
  }
  /// Force of the support: what is missing for the motion that it imposed. With a full mass matrix
  /// `force` has the inertia of all given motions of the block already.
  CDEM_HD Vec3<Real> react(Index i, const Vec3<Real>& v0, const Vec3<Real>& v1) const {
    const Vec3<Real> gained = (2.0 / (dt_before + dt)) * (v1 - v0);
    Real need[3] = {mass.mass[i] * gained.x, mass.mass[i] * gained.y, mass.mass[i] * gained.z};
    const Index row = mass.row(i);
    if (row >= 0) {
      need[0] = need[1] = need[2] = 0;
      for (Index j = 0; j < mass.block_count[i]; ++j) {
        Real a[3];
        const Index other = mass.block_first[i] + j;
        acceleration(other, a);
        for (Index axis = 0; axis < 3; ++axis)
          if (other != i && !supports.given(other, axis))
            need[axis] += mass.matrix[row + j] * a[axis];
      }
    }
    Real* r = reaction + std::size_t(i) * 4;
    for (Index axis = 0; axis < 3; ++axis)
      r[axis] = supports.given(i, axis) ? need[axis] - force[std::size_t(i) * 4 + axis] : 0.0;
    return {r[0], r[1], r[2]};
  }
};

/// Momentum M v of each node before the step: half of what the kinetic energy needs.
struct NodeMomentum {
  InMotion nodes;
  MassColumns mass;
  Real* momentum;  // row of 4  [kg m/s]

  CDEM_HD void operator()(One node) const {
    const Vec3<Real> p = mass.momentum(nodes, node.i);
    Real* r = momentum + std::size_t(node.i) * 4;
    r[0] = p.x, r[1] = p.y, r[2] = p.z;
  }
};

/// Energy of the nodes at the time of the forces; runs after the motion.
struct SampleNodes {
  InMotion nodes;        // velocity: after
  const Real* momentum;  // row of 4: M v before
  LoadColumns loads;
  SupportColumns supports;
  const Real* reaction;
  const Real* damping_force;
  Real dt;
  Real* sample;  // row of 4: kinetic energy; the external and the damping work of the half step
                 // that follows, which the sums contain already  [J]

  CDEM_HD void operator()(One node) const {
    const Index i = node.i;
    const Vec3<Real> v1 = nodes.velocity(i);
    Vec3<Real> external = loads.at(i);
    if (supports.support[i] >= 0) external = external + row(reaction, i);
    Real* r = sample + std::size_t(i) * 4;
    r[0] = 0.5 * dot(row(momentum, i), v1);
    r[1] = 0.5 * dt * dot(external, v1);
    r[2] = -0.5 * dt * dot(row(damping_force, i), v1);
  }

 private:
  CDEM_HD static Vec3<Real> row(const Real* rows, Index i) {
    const Real* r = rows + std::size_t(i) * 4;
    return {r[0], r[1], r[2]};
  }
};

}  // namespace cdem
