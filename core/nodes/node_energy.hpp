// node_energy.hpp - energy of the nodes at the time of the forces.
#pragma once

#include "core/nodes/loads.hpp"
#include "core/nodes/mass.hpp"
#include "core/nodes/supports.hpp"

namespace cdem {

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
