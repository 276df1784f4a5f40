// moved_node.hpp - kernels that move nodes to where a solve has found their rest, and book that.
#pragma once

#include "core/nodes/ports.hpp"
#include "core/nodes/supports.hpp"

namespace cdem {

/// The unbalanced force on the components of a node that may move  [N].
struct UnbalancedForce {
  const Real* force;  // rows of 4
  const Flag* free;   // [node][3]
  Real* unbalanced;   // [node][3]

  CDEM_HD void operator()(One node) const {
    for (Index k = 0; k < 3; ++k) {
      const std::size_t at = std::size_t(node.i) * 3 + k;
      unbalanced[at] = free[at] ? force[std::size_t(node.i) * 4 + k] : 0;
    }
  }
};

/// Move a node. Laws that follow the motion read it from the velocity, as if of one step.
struct MoveToRest {
  const Real* way;  // [node][3]  [m]
  LoadColumns loads;
  Real dt;              // [s]
  Real* motion;         // rows of 8
  Real* work_external;  // [node]

  CDEM_HD void operator()(One node) const {
    const Real* u = way + std::size_t(node.i) * 3;
    Real* row = motion + std::size_t(node.i) * 8;
    for (Index k = 0; k < 3; ++k) {
      row[k] += u[k];
      row[4 + k] = u[k] / dt;
    }
    work_external[node.i] += dot(loads.at(node.i).vector(), Vec3<Real>{u[0], u[1], u[2]});
  }
};

/// Stop it there. The mean of the unbalanced forces before and after has done the work that motion
/// would have brought to the damping.
struct StopAtRest {
  const Real *way, *before;  // [node][3]  [m], [N]
  const Real* force;         // rows of 4, now  [N]
  const Flag* free;          // [node][3]
  Real* motion;              // rows of 8
  Real* work_damping;        // [node]  [J]

  CDEM_HD void operator()(One node) const {
    Real work = 0;
    for (Index k = 0; k < 3; ++k) {
      const std::size_t at = std::size_t(node.i) * 3 + k;
      const Real now = free[at] ? force[std::size_t(node.i) * 4 + k] : 0;
      work += 0.5 * (before[at] + now) * way[at];
      motion[std::size_t(node.i) * 8 + 4 + k] = 0;
    }
    work_damping[node.i] += work;
  }
};

}  // namespace cdem
