// force_terms.hpp - forces on the nodes, and forces from round-off of positions.
#pragma once

#include "core/nodes/ports.hpp"
#include "core/nodes/supports.hpp"

namespace cdem {

/// The largest coordinate of a node  [m].
struct Farthest {
  const Real* motion;  // rows of 8
  CDEM_HD Real operator()(One node) const {
    Real farthest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      farthest = max_of(abs_of(motion[8 * std::size_t(node.i) + axis]), farthest);
    return farthest;
  }
};
/// Stiffness at a node  [N/m].
struct NodeStiffness {
  const Real *mass, *frequency_squared;
  CDEM_HD Real operator()(One node) const { return mass[node.i] * frequency_squared[node.i]; }
};
/// Size of the components of the load on a node that no support carries  [N].
struct AppliedForce {
  LoadColumns loads;
  SupportColumns supports;
  CDEM_HD Real operator()(One node) const {
    const Vec3<Real> f = loads.at(node.i).vector();
    const auto part = [&](Index axis, Real force) {
      return supports.given(node.i, axis) ? 0.0 : abs_of(force);
    };
    return part(0, f.x) + part(1, f.y) + part(2, f.z);
  }
};
/// Size of the components of a node's support force  [N].
struct CarriedForce {
  const Real* reaction;  // rows of 4
  CDEM_HD Real operator()(One node) const {
    const Real* r = reaction + std::size_t(node.i) * 4;
    return abs_of(r[0]) + abs_of(r[1]) + abs_of(r[2]);
  }
};

}  // namespace cdem
