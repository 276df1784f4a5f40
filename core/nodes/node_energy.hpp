// node_energy.hpp - energy of the nodes at the time of the forces.
#pragma once

#include "core/nodes/mass.hpp"
#include "core/nodes/ports.hpp"
#include "core/nodes/supports.hpp"

namespace cdem {

/// Kinetic energy of a node  [J].
struct KineticEnergy {
  InMotion nodes;
  MassColumns mass;

  CDEM_HD Real operator()(One node) const {
    return 0.5 * dot(mass.momentum(nodes, node.i).vector(), nodes.velocity(node.i));
  }
};

/// Zero the velocity of a node. The forces of this moment have worked since the middle of the last
/// step: their work  [J].
struct StopNode {
  const Real *force, *damping_force;  // rows of 4; null where nothing damps
  LoadColumns loads;
  Real since;    // [s]
  Real* motion;  // rows of 8
  Real *work_external, *work_damping;

  CDEM_HD Real operator()(One node) const {
    const Index i = node.i;
    Real* v = motion + std::size_t(i) * 8 + 4;
    const Vec3<Real> displacement = since * Vec3<Real>{v[0], v[1], v[2]};
    work_external[i] += dot(loads.at(i).vector(), displacement);
    if (damping_force)
      work_damping[i] -= dot(Row::at(damping_force + std::size_t(i) * 4).vector(), displacement);
    v[0] = v[1] = v[2] = 0;
    return dot(Row::at(force + std::size_t(i) * 4).vector(), displacement);
  }
};

/// Momentum M v of each node before the step, and v . M v: half of the terms of the kinetic energy.
/// Kept in the rows of `SampleNodes` until that has the other half.
struct NodeMomentum {
  InMotion nodes;
  MassColumns mass;
  Real* momentum;  // row of 4  [kg m/s], [J]

  CDEM_HD void operator()(One node) const {
    Row row = mass.momentum(nodes, node.i);
    row.n[3] = dot(row.vector(), nodes.velocity(node.i));
    row.store(momentum + std::size_t(node.i) * 4);
  }
};

/// Energy of the nodes at the time of the forces; runs after the motion.
///
/// The kinetic energy is that of the middle of the step before, 1/2 v . M v, and what the forces f
/// have done since then over half of that step, 1/2 dt_before f . v. With steps of one length that
/// is 1/2 v_before . M v_after. By the middle of this step the forces will have changed 1/2 v . M v
/// by their work over the mean of both steps, 1/4 (dt_before + dt) f . (v_before + v_after). That
/// is less than along the path, 1/2 f . (dt_before v_before + dt v_after), by the step change 1/4
/// (dt - dt_before) f . (v_after - v_before) = 1/8 (dt^2 - dt_before^2) f . M^-1 f.
struct SampleNodes {
  InMotion nodes;  // velocity: after
  MassColumns mass;
  LoadColumns loads;
  SupportColumns supports;
  const Real* reaction;
  const Real* damping_force;  // null where nothing damps
  Real dt_before, dt;
  Real* sample;  // row of 4, comes from NodeMomentum; kinetic energy; the external and the damping
                 // work of the half step that follows, and the step change of this step, which the
                 // sums contain already  [J]

  CDEM_HD void operator()(One node) const {
    const Index i = node.i;
    const Vec3<Real> v1 = nodes.velocity(i);
    Row external = loads.at(i);
    if (supports.support[i] >= 0) external = external + Row::at(reaction + std::size_t(i) * 4);
    Real* r = sample + std::size_t(i) * 4;
    const Real kick = 0.5 * (dt_before + dt), share = dt_before / kick;
    const Real before = r[3], mixed = dot(Row::at(r).vector(), v1);
    const Real after = dot(mass.momentum(nodes, i).vector(), v1);
    r[0] = 0.5 * (share * mixed + (1 - share) * before);
    r[3] = 0.25 * (dt - dt_before) / kick * (after - 2 * mixed + before);
    r[1] = 0.5 * dt * dot(external.vector(), v1);
    r[2] = damping_force ? -0.5 * dt * dot(Row::at(damping_force + std::size_t(i) * 4).vector(), v1)
                         : 0;
  }
};

}  // namespace cdem
