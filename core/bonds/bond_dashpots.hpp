// bond_dashpots.hpp - Rayleigh dashpots beside the springs of bond points that hold.
#pragma once

#include "core/bonds/bonded_pairs.hpp"

namespace cdem {

/// Change of a jump in the last step along the axes of its pair  [m].
template <class T>
CDEM_HD inline Vec3<T> change_along(const Frame<T>& now, const Vec3<T>& jump,
                                    const Frame<T>& before, const Vec3<T>& jump_before) {
  return {dot(now.n, jump) - dot(before.n, jump_before),
          dot(now.t1, jump) - dot(before.t1, jump_before),
          dot(now.t2, jump) - dot(before.t2, jump_before)};
}

/// Dashpots of the points of a set of pairs: each bears `time` times the stiffness of its spring
/// times the rate of the jump, while its bond holds. What they lose is counted by the mean force of
/// the step, as in RockDamping.
struct PairDashpots {
  Real dt;           // of the last step  [s]
  Real per_step;     // time of the dashpots over dt; 0 before there was a step
  InOutTable force;  // [axis * points + point][pair] in the last step, along the axes  [N]
  InOutTable work;   // [1][pair] taken out so far  [J]

  /// Force of point k of `points` on the second face, of pairs that are live; adds to the energy
  /// lost.
  template <class I, class T, class M>
  CDEM_HD Vec3<T> move_on(I p, Index k, Index points, const BondSpring<T>& spring,
                          const Frame<T>& frame, const Vec3<T>& change, const M& live,
                          const M& holds, T& lost) const {
    const T zero(0.0), scale = T(-per_step) * spring.area;
    const JointStiffness<T>& stiff = spring.stiffness;
    const Vec3<T> before{force.at(k, p), force.at(points + k, p), force.at(2 * points + k, p)};
    Vec3<T> own{scale * stiff.n * change.x, scale * stiff.s * change.y, scale * stiff.s * change.z};
    own = select(live & holds, own, Vec3<T>{zero, zero, zero});
    lost -= select(live, T(0.5) * dot(before + own, change), zero);
    // a released pair beside live ones in a lane keeps its state as it was
    const Vec3<T> kept = select(live, own, before);
    force.set(k, p, kept.x);
    force.set(points + k, p, kept.y);
    force.set(2 * points + k, p, kept.z);
    return own.x * frame.n + own.y * frame.t1 + own.z * frame.t2;
  }
};

/// Dashpots of conforming pairs; they add to the forces of ConformingBonds.
template <Index count>
struct BondDashpots {
  ConformingBonds<count> bonds;
  PairDashpots dashpots;

  template <class I>
  CDEM_HD void operator()(I p) const {
    using T = Number<I>;
    const auto live = bonds.pairs.are_live(p);
    if (!any_of(live)) return;
    Vec3<T> mean[count], mean_before[count], jump[count], rate[count], force[count];
    bonds.gather_vertices(p, mean, jump);
    move_inside<count>(bonds.indentation, jump);
    bonds.gather_rates(p, rate);
    bonds.gather_means_before(p, dashpots.dt, mean, mean_before);
    const Frame<T> frame = pair_frame<count>(mean), before = pair_frame<count>(mean_before);
    const BondSpring<T> spring = bonds.spring(p);
    T lost(0.0);
    for (Index k = 0; k < count; ++k) {
      const Vec3<T> change =
          change_along(frame, jump[k], before, jump[k] - T(dashpots.dt) * rate[k]);
      const auto holds = bonds.pairs.bond.at(k, p) > T(0.5);
      force[k] = dashpots.move_on(p, k, count, spring, frame, change, live, holds, lost);
    }
    bonds.move_to_vertices(force, [&](Index k, const Vec3<T>& of_vertex) {
      bonds.corner_force.add(p, count, k, of_vertex);
    });
    dashpots.work.set(0, p, dashpots.work.at(0, p) + lost);
  }
};

/// The same of faces that overlap. Their frame is taken as it is now: a jump is too short for its
/// turn in a step to matter.
struct OverlapDashpots {
  OverlapBonds bonds;
  PairDashpots dashpots;

  CDEM_HD void operator()(One p) const {
    if (!bonds.pairs.are_live(p)) return;
    const Index a = bonds.pair_faces[2 * p.i], b = bonds.pair_faces[2 * p.i + 1];
    const Frame<Real> frame = bonds.frame_of(a, b);
    const Vec3<Real> none{0.0, 0.0, 0.0};
    Vec3<Real> force[8] = {none, none, none, none, none, none, none, none};
    Real lost = 0;
    for (Index c = bonds.point_first[p.i]; c < bonds.point_first[p.i + 1]; ++c) {
      const One point{c};
      const Vec3<Real> change =
          change_along(frame, dashpots.dt * bonds.rate_of_jump(a, b, c), frame, none);
      const Vec3<Real> on_b =
          dashpots.move_on(point, 0, 1, bonds.pairs.spring(p, bonds.point_area[c]), frame, change,
                           true, bonds.pairs.bond.at(0, point) > 0.5, lost);
      for (Index k = 0; k < 4; ++k) {
        force[k] = force[k] - bonds.weights_a[4 * c + k] * on_b;
        force[4 + k] = force[4 + k] + bonds.weights_b[4 * c + k] * on_b;
      }
    }
    for (Index k = 0; k < 8; ++k) bonds.corner_force.add(p, 8, k, force[k]);
    dashpots.work.set(0, p, dashpots.work.at(0, p) + lost);
  }
};

}  // namespace cdem
