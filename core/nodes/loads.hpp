// loads.hpp - loads on nodes: gravity, and forces that follow curves of time.
#pragma once

#include "core/base/math.hpp"

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

}  // namespace cdem
