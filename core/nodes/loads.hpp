// loads.hpp - loads on nodes.
#pragma once

#include "core/base/math.hpp"

namespace cdem {

/// Loads on nodes: gravity, forces that follow curves of time, what is left of the forces of what
/// was dug out, and water.
struct LoadColumns {
  Vec3<Real> gravity;        // [m/s2]
  const Real* gravity_mass;  // [node] mass that gravity acts on  [kg]
  const Index* load_first;   // [node + 1]
  const Index* load_curve;   // curve that scales the load
  const Real* load_force;    // row of 4  [N]
  const Real* curve_value;   // [curve] factors at the time of this step
  const Real* relief;        // row of 4 a node, see run/excavate.hpp; null: none  [N]
  Real relief_part;          // that is left in this step
  const Real* water;         // row of 4 a node; null: none  [N]

  CDEM_HD Row at(Index node) const {
    Row f = gravity_mass[node] * Row::of(gravity.x, gravity.y, gravity.z);
    for (Index l = load_first[node]; l < load_first[node + 1]; ++l)
      f = f + curve_value[load_curve[l]] * Row::at(load_force + std::size_t(l) * 4);
    if (relief) f = f + relief_part * Row::at(relief + std::size_t(node) * 4);
    if (water) f = f + Row::at(water + std::size_t(node) * 4);
    return f;
  }
};

}  // namespace cdem
