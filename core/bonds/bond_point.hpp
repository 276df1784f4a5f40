// bond_point.hpp - one bond point: a spring between two faces until it breaks. Feng et al. (2014),
// Eq. 13-14.
#pragma once

#include "core/contact/geometry/face.hpp"
#include "core/interfaces/brittle_coulomb.hpp"

namespace cdem {

/// Stiffness and strength of one bond point: those of the interface times the point's share of the
/// true overlap area, so that strength does not depend on which side is meshed finer.
template <class T>
struct BondLaw {
  T stiffness_n, stiffness_s;       // K_n, K_s  [N/m]
  T tension_limit, cohesion_limit;  // T A, c A  [N]
  T tan_friction;
};

/// History of one bond point. While it is intact there is none: `slip` stays zero.
template <class T>
struct BondHistory {
  T bond;          // 1 while intact, then 0
  T slip1, slip2;  // plastic slip in the pair's frame  [m]
};

/// What one bond point does in a step.
template <class T>
struct BondForce {
  Vec3<T> on_b;          // force on the second face  [N]
  T stored;              // elastic energy  [J]
  T fracture, friction;  // energy lost in this step  [J]
  T tension, shear;      // 1 when the bond broke in this step, by that cause
};

/// Elastic energy of a bond point  [J].
template <class T>
CDEM_HD inline T stored_energy(const BondLaw<T>& law, const T& force_n, const T& force_s1,
                               const T& force_s2) {
  const T half(0.5), half_compliance_n = half / law.stiffness_n,
                     half_compliance_s = half / law.stiffness_s;
  return half_compliance_n * force_n * force_n +
         half_compliance_s * (force_s1 * force_s1 + force_s2 * force_s2);
}

/// Does an intact bond point bear this jump? Then `on_b` is what bond_force gives, without the
/// history that an intact point does not have.
template <class T>
CDEM_HD inline auto bears(const Frame<T>& frame, const Vec3<T>& jump, const BondLaw<T>& law,
                          Vec3<T>& on_b) {
  const T force_n = -law.stiffness_n * dot(frame.n, jump);
  const T force_s1 = -law.stiffness_s * dot(frame.t1, jump);
  const T force_s2 = -law.stiffness_s * dot(frame.t2, jump);
  on_b = force_n * frame.n + force_s1 * frame.t1 + force_s2 * frame.t2;
  const ForceLimit<T> limit(law.tension_limit, law.cohesion_limit, law.tan_friction, T(1.0),
                            force_n);
  return !(limit.opens(force_n) | limit.slips(force_s1 * force_s1 + force_s2 * force_s2));
}

/// Elastic energy of an intact bond point  [J].
template <class T>
CDEM_HD inline T intact_energy(const Frame<T>& frame, const Vec3<T>& jump, const BondLaw<T>& law) {
  return stored_energy(law, law.stiffness_n * dot(frame.n, jump),
                       law.stiffness_s * dot(frame.t1, jump),
                       law.stiffness_s * dot(frame.t2, jump));
}

/// Force of one bond point from the jump of displacement x_b - x_a across it, Eq. 13-14.
///
/// The force is total, not incremental: F_n = -K_n n.jump, F_s = -K_s (t.jump - slip), so it cannot
/// drift and needs no history until it slips. A point that broke but whose pair is not yet released
/// to the search goes on as a frictional contact at the same place; in an open hinge (`searched`),
/// whose faces the search has already, it carries nothing.
/// `jump_old` is the jump one step ago; it serves only the energy ledger: what is lost is
/// U_old - U_new + work done on the spring by the mean force.
template <class T, class M>
CDEM_HD inline BondForce<T> bond_force(const Frame<T>& frame, const Vec3<T>& jump,
                                       const Vec3<T>& jump_old, const BondLaw<T>& law,
                                       const M& searched, BondHistory<T>& h) {
  const T zero(0.0), one(1.0), half(0.5);
  const T opening = dot(frame.n, jump), along1 = dot(frame.t1, jump), along2 = dot(frame.t2, jump);
  T force_n = -law.stiffness_n * opening;
  T force_s1 = -law.stiffness_s * (along1 - h.slip1);
  T force_s2 = -law.stiffness_s * (along2 - h.slip2);

  const T before = h.bond;
  const auto pulled = -force_n > before * law.tension_limit;  // else it slipped
  limit_force(law.tension_limit, law.cohesion_limit, law.tan_friction, h.bond, force_n, force_s1,
              force_s2);
  const auto carries = (h.bond > half) | !searched;
  force_n = select(carries, force_n, zero);
  force_s1 = select(carries, force_s1, zero);
  force_s2 = select(carries, force_s2, zero);

  BondForce<T> out;
  const auto broke = before > h.bond;
  out.tension = select(broke & pulled, one, zero);
  out.shear = select(broke, one, zero) - out.tension;

  // the slip that makes the elastic law give the limited force
  const T slip1 = select(h.bond > half, h.slip1, along1 + force_s1 / law.stiffness_s);
  const T slip2 = select(h.bond > half, h.slip2, along2 + force_s2 / law.stiffness_s);

  out.stored = stored_energy(law, force_n, force_s1, force_s2);
  out.fracture = zero;
  out.friction = zero;
  if (any_of(h.bond < half)) {
    const T half_compliance_n = half / law.stiffness_n, half_compliance_s = half / law.stiffness_s;
    const T stored_n = half_compliance_n * force_n * force_n;
    const T stored_s = half_compliance_s * (force_s1 * force_s1 + force_s2 * force_s2);
    const T old_n = dot(frame.n, jump_old);
    const T old1 = dot(frame.t1, jump_old), old2 = dot(frame.t2, jump_old);
    const T was_n =
        select(before > half, -law.stiffness_n * old_n, max_of(-law.stiffness_n * old_n, zero));
    const auto was_open = (!(was_n > zero)) & (before < half);
    const T was_s1 = select(was_open, zero, -law.stiffness_s * (old1 - h.slip1));
    const T was_s2 = select(was_open, zero, -law.stiffness_s * (old2 - h.slip2));
    const T lost_s =
        half_compliance_s * (was_s1 * was_s1 + was_s2 * was_s2) - stored_s -
        half * ((was_s1 + force_s1) * (along1 - old1) + (was_s2 + force_s2) * (along2 - old2));
    const T lost_n =
        half_compliance_n * was_n * was_n - stored_n - half * (was_n + force_n) * (opening - old_n);
    out.fracture = select(broke, lost_n + lost_s, zero);
    out.friction = select((!broke) & (h.bond < half) & carries, lost_s, zero);
  }
  h.slip1 = slip1;
  h.slip2 = slip2;
  out.on_b = force_n * frame.n + force_s1 * frame.t1 + force_s2 * frame.t2;
  return out;
}

}  // namespace cdem
