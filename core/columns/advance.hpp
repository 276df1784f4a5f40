// advance.hpp - columns of ground beside the sides of a model, one step on.
//
// A column is ground in one dimension: its levels move in x, y and z, and nothing varies between
// two points of one height. Between two levels the strains are eps_zz = du_z/dz,
// gamma_xz = du_x/dz and gamma_yz = du_y/dz. Masses are lumped at the levels, and the step is the
// one of nodes, see nodes/central_difference.hpp and nodes/dashpots.hpp.
#pragma once

#include "core/base/views.hpp"
#include "core/nodes/supports.hpp"

namespace cdem {

/// Numbers of a layer between two levels.
struct Layers {
  const Real* rows;  // row of 4: height [m], lambda + 2 mu, lambda, mu [Pa]
  CDEM_HD Row at(Index layer) const { return Row::at(rows + std::size_t(layer) * 4); }
};

/// Stress on a horizontal plane in a layer, x y z, by the displacements of its levels  [Pa].
CDEM_HD inline Vec3<Real> stress_across(const Row& layer, const Vec3<Real>& below,
                                        const Vec3<Real>& above) {
  const Vec3<Real> slope = (1.0 / layer.n[0]) * (above - below);
  return {layer.n[3] * slope.x, layer.n[3] * slope.y, layer.n[1] * slope.z};
}

/// Displacement and velocity of levels, per area of the column.
struct ColumnMotion {
  Real* displacement;  // row of 4, at the time of this step  [m]
  Real* before;        // row of 4, velocity half a step before  [m/s]
  Real* after;         // row of 4, and half a step after  [m/s]
};

/// Move the levels of a column: an item is a column.
///
/// `after` follows from the rest alone, so a second call in the same step gives the same. The next
/// step takes it over first.
struct AdvanceColumns {
  const Index* level_first;  // [column + 1]; a column has one layer less than levels
  Layers layers;             // by the number of the level below, see layer_of
  const Real* mass;          // [level]  [kg/m2]
  const Real* foot;          // [column] row of 4: dashpots x y z [kg/(m2 s)], 1: the foot is driven
  const Index* input_first;  // [column + 1]
  const Index* input_curve;  // [input]
  const Real* input;         // [input] row of 4: traction [Pa] or velocity [m/s] of a factor of 1
  const Real* curve_value;   // [curve] at this time
  const Real* curve_velocity;  // [curve] at the middle of the coming step
  const Flag* acts;            // [column] 1: it moves; 0: it is held
  Real mass_damping;           // [1/s]
  Real dt_before, dt;          // [s]
  Index step;                  // number of this step
  Index* made;                 // [column] of the step of `after`, or -1
  ColumnMotion motion;

  CDEM_HD void operator()(One column) const {
    const Index first = level_first[column.i], last = level_first[column.i + 1];
    if (made[column.i] >= 0 && made[column.i] < step)
      for (Index l = first; l < last; ++l) take_over(l);
    made[column.i] = step;
    if (!acts[column.i]) {
      for (Index l = first; l < last; ++l) {
        Row::zero().store(motion.before + std::size_t(l) * 4);
        Row::zero().store(motion.after + std::size_t(l) * 4);
      }
      return;
    }
    const Real* own = foot + std::size_t(column.i) * 4;
    Vec3<Real> below{0.0, 0.0, 0.0};  // stress in the layer under the level
    for (Index l = first; l < last; ++l) {
      Vec3<Real> above{0.0, 0.0, 0.0};
      if (l + 1 < last) above = stress_across(layers.at(l), displacement(l), displacement(l + 1));
      Vec3<Real> f = above - below;
      below = above;
      if (l == first && own[3] != 0)
        driven(column.i).store(motion.after + std::size_t(l) * 4);
      else if (l == first)
        move(l, f + traction(column.i), {own[0], own[1], own[2]});
      else
        move(l, f, {0.0, 0.0, 0.0});
    }
  }

 private:
  CDEM_HD Vec3<Real> displacement(Index l) const {
    return Row::at(motion.displacement + std::size_t(l) * 4).vector();
  }
  /// The last step is over: what was its velocity moves the level.
  CDEM_HD void take_over(Index l) const {
    const std::size_t at = std::size_t(l) * 4;
    const Row v = Row::at(motion.after + at);
    (Row::at(motion.displacement + at) + dt_before * v).store(motion.displacement + at);
    v.store(motion.before + at);
  }
  CDEM_HD void move(Index l, const Vec3<Real>& force, const Vec3<Real>& dashpot) const {
    const std::size_t at = std::size_t(l) * 4;
    const Real m = mass[l], tau = 0.5 * (dt_before + dt);
    const Row v = Row::at(motion.before + at);
    const Real f[3] = {force.x, force.y, force.z}, c[3] = {dashpot.x, dashpot.y, dashpot.z};
    Real next[3];
    for (Index a = 0; a < 3; ++a) {
      const Real need = f[a] - mass_damping * m * v.n[a] - c[a] * v.n[a];
      next[a] = v.n[a] + need / (m / tau + 0.5 * c[a]);
    }
    Row::of(next[0], next[1], next[2]).store(motion.after + at);
  }
  CDEM_HD Vec3<Real> traction(Index column) const { return sum(column, curve_value).vector(); }
  CDEM_HD Row driven(Index column) const { return sum(column, curve_velocity); }
  CDEM_HD Row sum(Index column, const Real* factor) const {
    Row all = Row::zero();
    for (Index k = input_first[column]; k < input_first[column + 1]; ++k)
      all = all + factor[input_curve[k]] * Row::at(input + std::size_t(k) * 4);
    return all;
  }
};

}  // namespace cdem
