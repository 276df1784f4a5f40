// advance.hpp - columns of ground beside the sides of a model, one step on.
//
// A column is ground in one dimension: its levels move in x, y and z, and nothing varies between
// two points of one height. Between two levels the strains are eps_zz = du_z/dz,
// gamma_xz = du_x/dz and gamma_yz = du_y/dz. Masses are lumped at the levels, and the step is the
// one of nodes, see nodes/central_difference.hpp and nodes/dashpots.hpp. Its damping is that of the
// rock, see elements/rock_damping.hpp and bonds/bond_dashpots.hpp.
#pragma once

#include "core/base/views.hpp"
#include "core/nodes/supports.hpp"
#include "core/records/branch_step.hpp"

namespace cdem {

/// Displacement and velocity of levels, and strains of Maxwell branches in the layers above them.
struct ColumnMotion {
  Real* displacement;  // row of 4, at the time of this step  [m]
  Real* before;        // row of 4, velocity half a step before  [m/s]
  Real* after;         // row of 4, and half a step after  [m/s]
  Real* branch;        // row of 4 for each branch, slopes of its spring; null: none

  CDEM_HD static Vec3<Real> at(const Real* rows, Index number) {
    return Row::at(rows + std::size_t(number) * 4).vector();
  }
  /// Change over the layer above a level.
  CDEM_HD static Vec3<Real> over(const Real* rows, Index level) {
    return at(rows, level + 1) - at(rows, level);
  }
};

/// The layer above a level: rock, or the bond of two groups. It has the number of the level.
struct Layers {
  const Real* rows;           // row of 4: height [m], lambda + 2 mu, lambda, mu [Pa]
  const Flag* bond;           // [level] 1: it is a bond, with a height of 1
  Real rock_time, bond_time;  // of Rayleigh dashpots in rock and in bonds  [s]
  BranchStep maxwell;         // of the last step
  ColumnMotion motion;

  CDEM_HD Row at(Index layer) const { return Row::at(rows + std::size_t(layer) * 4); }

  /// Stress on a horizontal plane, x y z  [Pa].
  CDEM_HD Vec3<Real> stress_across(Index layer) const {
    const Row own = at(layer);
    const Real time = bond[layer] ? bond_time : rock_time;
    Vec3<Real> slope = (1.0 / own.n[0]) * (motion.over(motion.displacement, layer) +
                                           time * motion.over(motion.before, layer));
    if (motion.branch && !bond[layer])
      for (Index j = 0; j < BranchStep::count; ++j)
        slope = slope + maxwell.weight[j] * motion.at(motion.branch, layer * BranchStep::count + j);
    return {own.n[3] * slope.x, own.n[3] * slope.y, own.n[1] * slope.z};
  }
  /// Move its branches on over the last step, in which its levels had the velocity `after`.
  CDEM_HD void move_branches(Index layer, Real dt) const {
    const Vec3<Real> change = (dt / at(layer).n[0]) * motion.over(motion.after, layer);
    for (Index j = 0; j < BranchStep::count; ++j) {
      const Index number = layer * BranchStep::count + j;
      const Vec3<Real> spring = maxwell.next<Real>(motion.at(motion.branch, number), change, j);
      Row::of(spring.x, spring.y, spring.z).store(motion.branch + std::size_t(number) * 4);
    }
  }
};

/// Move the levels of a column: an item is a column.
///
/// `after` follows from the rest alone, so a second call in the same step gives the same. The next
/// step takes it over first.
struct AdvanceColumns {
  const Index* level_first;  // [column + 1]; a column has one layer less than levels
  Layers layers;
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

  CDEM_HD void operator()(One column) const {
    const Index first = level_first[column.i], last = level_first[column.i + 1];
    if (made[column.i] >= 0 && made[column.i] < step) take_over(first, last);
    made[column.i] = step;
    if (!acts[column.i]) {
      for (Index l = first; l < last; ++l) {
        Row::zero().store(layers.motion.before + std::size_t(l) * 4);
        Row::zero().store(layers.motion.after + std::size_t(l) * 4);
      }
      return;
    }
    const Real* own = foot + std::size_t(column.i) * 4;
    Vec3<Real> below{0.0, 0.0, 0.0};  // stress in the layer under the level
    for (Index l = first; l < last; ++l) {
      Vec3<Real> above{0.0, 0.0, 0.0};
      if (l + 1 < last) above = layers.stress_across(l);
      Vec3<Real> f = above - below;
      below = above;
      if (l == first && own[3] != 0)
        driven(column.i).store(layers.motion.after + std::size_t(l) * 4);
      else if (l == first)
        move(l, f + traction(column.i), {own[0], own[1], own[2]});
      else
        move(l, f, {0.0, 0.0, 0.0});
    }
  }

 private:
  /// The last step is over: its velocity moves levels and branches.
  CDEM_HD void take_over(Index first, Index last) const {
    for (Index l = first; layers.motion.branch && l + 1 < last; ++l)
      layers.move_branches(l, dt_before);
    for (Index l = first; l < last; ++l) {
      const std::size_t at = std::size_t(l) * 4;
      const Row v = Row::at(layers.motion.after + at);
      (Row::at(layers.motion.displacement + at) + dt_before * v)
          .store(layers.motion.displacement + at);
      v.store(layers.motion.before + at);
    }
  }
  CDEM_HD void move(Index l, const Vec3<Real>& force, const Vec3<Real>& dashpot) const {
    const std::size_t at = std::size_t(l) * 4;
    const Real m = mass[l], tau = 0.5 * (dt_before + dt);
    const Row v = Row::at(layers.motion.before + at);
    const Real f[3] = {force.x, force.y, force.z}, c[3] = {dashpot.x, dashpot.y, dashpot.z};
    Real next[3];
    for (Index a = 0; a < 3; ++a) {
      const Real need = f[a] - mass_damping * m * v.n[a] - c[a] * v.n[a];
      next[a] = v.n[a] + need / (m / tau + 0.5 * c[a]);
    }
    Row::of(next[0], next[1], next[2]).store(layers.motion.after + at);
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
