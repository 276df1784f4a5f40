// peak_speed.hpp - largest speed of each node so far.
#pragma once

#include "core/nodes/mass.hpp"

namespace cdem {

/// Keep the larger of the squared speed of a node now and before.
struct KeepPeak {
  InMotion nodes;
  Real* peak;  // [node] largest squared speed  [m2/s2]

  CDEM_HD void operator()(One node) const {
    const Vec3<Real> v = nodes.velocity(node.i);
    const Real now = dot(v, v);
    if (now > peak[node.i]) peak[node.i] = now;
  }
};

}  // namespace cdem
