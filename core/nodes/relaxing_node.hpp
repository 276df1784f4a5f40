// relaxing_node.hpp - a node in adaptive relaxation.
#pragma once

#include "core/nodes/ports.hpp"
#include "core/nodes/supports.hpp"

namespace cdem {

/// Forces on nodes without damping, one component  [N].
struct Undamped {
  const Real *force, *damping;  // rows of 4; null where nothing damps
  CDEM_HD Real operator()(std::size_t i, std::size_t k) const {
    return damping ? force[4 * i + k] - damping[4 * i + k] : force[4 * i + k];
  }
};

/// Remember force and velocity of a step; the node has not been slowed down since.
struct RememberNode {
  Undamped undamped;
  const Real* motion;  // rows of 8
  Real* remembered;    // rows of 8: undamped force, remaining fraction of its velocity; velocity

  CDEM_HD void operator()(One node) const {
    const std::size_t i = node.i;
    for (std::size_t k = 0; k < 3; ++k) {
      remembered[8 * i + k] = undamped(i, k);
      remembered[8 * i + 4 + k] = motion[8 * i + 4 + k];
    }
    remembered[8 * i + 3] = 1;
  }
};

/// Leave a node that much of its velocity, where it is not given.
struct SlowNode {
  SupportColumns supports;
  const Real* remembered;
  Real* motion;

  CDEM_HD void operator()(One node) const {
    const std::size_t row = 8 * std::size_t(node.i);
    for (Index axis = 0; axis < 3; ++axis)
      if (!supports.given(node.i, axis)) motion[row + 4 + axis] *= remembered[row + 3];
  }
};

/// Nodes that were slowed down at the time of the forces moved with their old velocity until then:
/// work of the forces in the half step that their new velocity lacks  [J]. That of the loads
/// is booked.
struct SlowedWork {
  Undamped undamped;
  LoadColumns loads;
  SupportColumns supports;
  const Real* remembered;
  Real half_step;  // [s]
  Real* work_external;

  CDEM_HD Real operator()(One node) const {
    const std::size_t i = node.i;
    const Real* before = remembered + 8 * i;
    const Row displacement = supports.without_given(
        node.i, (half_step * (1 - before[3])) * Row::of(before[4], before[5], before[6]));
    work_external[i] += dot(loads.at(node.i).vector(), displacement.vector());
    return dot(Vec3<Real>{undamped(i, 0), undamped(i, 1), undamped(i, 2)}, displacement.vector());
  }
};

/// v . K v of a node for the last displacement over dt, from the change of the forces.
struct StiffnessInMotion {
  Undamped undamped;
  const Real* remembered;

  CDEM_HD Real operator()(One node) const {
    const std::size_t i = node.i;
    const Real* before = remembered + 8 * i;
    Real sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum -= before[4 + k] * (undamped(i, k) - before[k]);
    return sum;
  }
};

/// v . M v of a node.
struct MassInMotion {
  const Real *mass, *remembered;

  CDEM_HD Real operator()(One node) const {
    const Real* v = remembered + 8 * std::size_t(node.i) + 4;
    return mass[node.i] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
};

}  // namespace cdem
