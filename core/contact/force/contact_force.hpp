// contact_force.hpp - normal, shear and dashpot force of one contact. Feng et al. (2014), Eq.
// 13-14.
#pragma once

#include "core/contact/geometry/face.hpp"
#include "core/records/contact_records.hpp"

namespace cdem {

/// The gap at which a contact that begins is free of stress.
///
/// A contact met from outside is free at zero gap. One that is found already inside must not
/// release energy that nothing put in (faces of freshly broken rock have slid a little past each
/// other, a vertex turns a corner): it may begin with the energy of the contact it takes over from,
/// `penetration_before` deep; what is deeper counts as free of stress.
/// `dilated` is how far that contact had opened by dilation.
template <class T>
CDEM_HD inline T starting_stress_free_gap(T gap, T gap_rate, T dt, T penetration_before,
                                          T dilated) {
  const T gap_before = gap - gap_rate * dt;
  return min_of(gap_before + penetration_before, dilated);
}

/// Once a contact is lifted past its stress-free gap, that gap follows it back towards zero; one
/// that has dilated stays on top of its asperities.
template <class T>
CDEM_HD inline T lifted_stress_free_gap(T stress_free_gap, T gap) {
  const T zero(0.0);
  return select(stress_free_gap > zero, stress_free_gap,
                min_of(max_of(stress_free_gap, gap), zero));
}

/// Elastic and frictional part of one contact's force.
template <class T>
struct ContactForce {
  T force_n;             // compression > 0  [N]
  T penetration;         // effective penetration  [m]
  T shear1, shear2;      // on the mother  [N]
  T energy_n, energy_s;  // stored  [J]
  T friction;            // lost in this step  [J]
  T dashpot;             // lost in this step  [J]
  T lift;                // of the stress-free gap, by dilation in this step  [m]
};

/// What a sliding contact needs to know of its asperities.
template <class T>
struct Dilation {
  T tangent;  // tan(psi)
  T room;     // opening that is left before it dilates no more  [m]
};

/// What a contact had one step ago; all zero for one that begins.
template <class T>
struct ContactBefore {
  T force_n, penetration;  // [N], [m]
  T shear1, shear2;        // [N]
};

/// Normal force from the total gap, shear force from the step's slip, then Coulomb's limit.
///
/// `slip` is the relative tangential displacement of the step in the target's own frame: because
/// the tangential part of (mother point - target point) is zero now, it is minus the tangential
/// part that the same two material points had one step ago in the frame of one step ago. That makes
/// it exactly objective: a rigid rotation of a loaded pair gives none.
///
/// What dashpot and friction take is the work of their mean force in the step: what central
/// differences make of it. (The new force alone with the rate, which is that of half a step ago,
/// read up to 8 % of an impact's energy too much.)
///
/// A joint that slips by ds lifts by tan(psi) ds (dilation): its stress-free gap rises, which
/// presses it harder and so raises the limit. Both are solved for at once; friction pays for the
/// lift.
template <class T>
CDEM_HD inline ContactForce<T> contact_force(T stiffness_n, T stiffness_s, T tan_friction, T gap,
                                             T gap_rate, T dashpot_constant, T slip1, T slip2,
                                             const ContactBefore<T>& before,
                                             const Dilation<T>& dilation, T dt) {
  const T zero(0.0), half(0.5), one(1.0);
  ContactForce<T> f;
  T elastic = max_of(-stiffness_n * gap, zero);
  f.force_n = select(gap < zero, max_of(elastic - dashpot_constant * gap_rate, zero), zero);
  f.penetration = max_of(-gap, zero);
  const T old1 = before.shear1, old2 = before.shear2;
  const T try1 = old1 - stiffness_s * slip1, try2 = old2 - stiffness_s * slip2;
  const T shear = sqrt_of(try1 * try1 + try2 * try2);
  T limit = f.force_n * tan_friction;
  f.lift = zero;
  const auto dilates = (dilation.tangent > zero) & (f.force_n > zero) & (shear > limit);
  if (any_of(dilates)) {
    const T stiffer = stiffness_s + stiffness_n * dilation.tangent * tan_friction;
    const T lift = min_of(dilation.tangent * (shear - limit) / stiffer, dilation.room);
    f.lift = select(dilates, lift, zero);
    f.penetration += f.lift;
    f.force_n += stiffness_n * f.lift;
    elastic += stiffness_n * f.lift;
    limit = f.force_n * tan_friction;
  }
  const T keep = select(shear > limit, limit / shear, one);
  f.shear1 = keep * try1;
  f.shear2 = keep * try2;
  const T half_compliance_s = half / stiffness_s;
  const T stored_s = half_compliance_s * (f.shear1 * f.shear1 + f.shear2 * f.shear2);
  f.friction = half_compliance_s * (old1 * old1 + old2 * old2) - stored_s -
               half * ((old1 + f.shear1) * slip1 + (old2 + f.shear2) * slip2) -
               half * (stiffness_n * before.penetration + elastic) * f.lift;
  f.energy_n = half / stiffness_n * elastic * elastic;
  f.energy_s = stored_s;
  const T braked = before.force_n - stiffness_n * before.penetration + f.force_n - elastic;
  f.dashpot = -half * braked * gap_rate * dt;
  return f;
}

}  // namespace cdem
