// bond_dashpots.hpp - Rayleigh dashpots beside the springs of bond points that hold.
#pragma once

#include "core/bonds/bonded_pairs.hpp"

namespace cdem {

/// Force of the dashpot of a bond point on the second face: `damping_time` times the stiffness of
/// its spring times the rate of the jump  [N].
template <class T>
CDEM_HD inline Vec3<T> dashpot_force(const BondSpring<T>& spring, const Frame<T>& frame,
                                     const Vec3<T>& rate, Real damping_time) {
  const JointStiffness<T>& k = spring.stiffness;
  const Vec3<T> traction = (k.n * dot(frame.n, rate)) * frame.n +
                           (k.s * dot(frame.t1, rate)) * frame.t1 +
                           (k.s * dot(frame.t2, rate)) * frame.t2;
  return (T(-damping_time) * spring.area) * traction;
}

/// Dashpots of conforming pairs; they add to the forces of ConformingBonds.
template <Index count>
struct BondDashpots {
  ConformingBonds<count> bonds;
  Real damping_time;        // [s]
  Real dt;                  // of this step  [s]
  InOutTable damping_work;  // [1][pair] taken out so far  [J]

  template <class I>
  CDEM_HD void operator()(I p) const {
    using T = Number<I>;
    const auto live = bonds.pairs.are_live(p);
    if (!any_of(live)) return;
    Vec3<T> mean[count], rate[count];
    bonds.gather_vertices(p, mean, rate);
    const Frame<T> frame = pair_frame<count>(mean);
    bonds.gather_rates(p, rate);
    const BondSpring<T> spring = bonds.spring(p);
    const T zero(0.0);
    const Vec3<T> none{zero, zero, zero};
    T power = zero;
    for (Index k = 0; k < count; ++k) {
      const Vec3<T> force = dashpot_force(spring, frame, rate[k], damping_time);
      const auto holds = live & (bonds.pairs.bond.at(k, p) > T(0.5));
      power -= select(holds, dot(force, rate[k]), zero);
      rate[k] = select(holds, force, none);
    }
    bonds.move_to_vertices(rate);
    for (Index k = 0; k < count; ++k) bonds.corner_force.add(p, count, k, rate[k]);
    damping_work.set(0, p, damping_work.at(0, p) + T(dt) * power);
  }
};

/// The same of faces that overlap.
struct OverlapDashpots {
  OverlapBonds bonds;
  Real damping_time;        // [s]
  Real dt;                  // of this step  [s]
  InOutTable damping_work;  // [1][pair] taken out so far  [J]

  CDEM_HD void operator()(One p) const {
    if (!bonds.pairs.are_live(p)) return;
    const Index a = bonds.pair_faces[2 * p.i], b = bonds.pair_faces[2 * p.i + 1];
    const Frame<Real> frame = bonds.frame_of(a, b);
    const Vec3<Real> none{0.0, 0.0, 0.0};
    Vec3<Real> force[8] = {none, none, none, none, none, none, none, none};
    Real power = 0;
    for (Index c = bonds.point_first[p.i]; c < bonds.point_first[p.i + 1]; ++c) {
      if (!(bonds.pairs.bond.at(0, One{c}) > 0.5)) continue;
      const Vec3<Real> rate = bonds.rate_of_jump(a, b, c);
      const Vec3<Real> on_b =
          dashpot_force(bonds.pairs.spring(p, bonds.point_area[c]), frame, rate, damping_time);
      power -= dot(on_b, rate);
      for (Index k = 0; k < 4; ++k) {
        force[k] = force[k] - bonds.weights_a[4 * c + k] * on_b;
        force[4 + k] = force[4 + k] + bonds.weights_b[4 * c + k] * on_b;
      }
    }
    for (Index k = 0; k < 8; ++k) bonds.corner_force.add(p, 8, k, force[k]);
    damping_work.set(0, p, damping_work.at(0, p) + dt * power);
  }
};

}  // namespace cdem
