// side.hpp - forces of columns of ground on the nodes of the sides beside them.
#pragma once

#include "core/columns/advance.hpp"

namespace cdem {

/// Force of a column on a node of a side: the change of its stress on the faces there, and the part
/// of the dashpots between them that the column moves. An item is a node of a side.
///
///   f = sum S(layer) n W + C (v- + v+)/2 of the column,  where W is the integral of the shape
///   function over the part of the faces in that layer
struct SideForces {
  const Index* layer_first;  // [item + 1]
  const Index* layer;        // by the number of the level below
  const Real* area;          // row of 4: n W, x y, two pads  [m2]
  const Index* level;        // [item] the level below the node, or beside it
  const Real* part;          // [item] way from that level to the next above it  [1]
  const Real* dashpot;       // [item] row of 8: xx yy zz xy yz zx, two pads  [kg/s]
  Layers layers;
  OutForces out;

  CDEM_HD void operator()(One item) const {
    Vec3<Real> f = drag(item.i);
    for (Index k = layer_first[item.i]; k < layer_first[item.i + 1]; ++k) {
      const Row rock = layers.at(layer[k]);
      const Vec3<Real> across = layers.stress_across(layer[k]);
      // strains along x and y are zero: both normal stresses are lambda eps_zz
      const Real beside = rock.n[2] / rock.n[1] * across.z;
      const Real* n = area + std::size_t(k) * 4;
      f = f + Vec3<Real>{beside * n[0], beside * n[1], across.x * n[0] + across.y * n[1]};
    }
    out.set(item, 1, 0, f);
  }

 private:
  /// Mean velocity of the column in this step, at the height of the node.
  CDEM_HD Vec3<Real> mean(Index i) const {
    const ColumnMotion& motion = layers.motion;
    const auto of = [&](Index l) {
      return 0.5 * (motion.at(motion.before, l) + motion.at(motion.after, l));
    };
    const Real up = part[i];
    const Vec3<Real> low = of(level[i]);
    return up == 0 ? low : (1.0 - up) * low + up * of(level[i] + 1);
  }
  CDEM_HD Vec3<Real> drag(Index i) const {
    const Real* c = dashpot + std::size_t(i) * 8;
    const Vec3<Real> v = mean(i);
    return {c[0] * v.x + c[3] * v.y + c[5] * v.z, c[3] * v.x + c[1] * v.y + c[4] * v.z,
            c[5] * v.x + c[4] * v.y + c[2] * v.z};
  }
};

}  // namespace cdem
