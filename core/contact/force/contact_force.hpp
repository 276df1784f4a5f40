// contact_force.hpp - normal, shear and dashpot force of one contact. Feng et al. (2014), Eq.
// 13-14.
#pragma once

#include "core/contact/force/contact_spring.hpp"
#include "core/interfaces/law.hpp"
#include "core/records/contact_records.hpp"

namespace cdem {

/// The gap at which a contact that begins is free of stress.
///
/// A contact met from outside is free at zero gap. One that is found already inside must not
/// release energy that nothing put in (faces of freshly broken rock have slid a little past each
/// other, a vertex turns a corner): it may begin with the energy of the contact it takes over from,
/// `penetration_before` deep; deeper penetration counts as free of stress.
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

/// Results of a contact in the step.
///
/// `slip` is the relative tangential displacement of the step in the target's own frame: because
/// the tangential part of (mother point - target point) is zero now, it is minus the tangential
/// part that the same two material points had one step ago in the frame of one step ago. That makes
/// it exactly objective: a rigid rotation of a loaded pair gives none.
template <class T>
struct ContactMotion {
  T gap;              // past the stress-free gap  [m]
  T stress_free_gap;  // [m]
  T gap_rate;         // [m/s]
  T slip1, slip2;     // of the step  [m]
  T dashpot;          // [N s/m]
  Real dt;            // [s]
};

/// State of a contact one step ago; all zero for a new one.
template <class T>
struct ContactBefore {
  T force_n, penetration;  // [N], [m]
  T shear1, shear2;        // [N]
  T approach = T(0.0);     // of a hysteretic contact  [m]
};

/// Force of one contact, stored and lost energy.
template <class T>
struct ContactForce {
  T force_n;             // compression > 0  [N]
  T penetration;         // effective penetration  [m]
  T shear1, shear2;      // on the mother  [N]
  T energy_n, energy_s;  // stored  [J]
  T friction;            // lost in this step  [J]
  T dashpot;             // lost in this step  [J]
  T rise;                // of the stress-free gap, by dilation in this step  [m]
};

/// Is a contact pressed hard enough that its line of action meets the target near by? A law whose
/// shear does not fall with the pressure may push a contact along that is hardly pressed at all.
template <class T>
CDEM_HD inline Truth<T> meets_target(const ContactForce<T>& f) {
  const T steepest(10.0);  // shear over normal force: more than friction has
  const T reach = steepest * f.force_n;
  return (f.force_n > T(0.0)) & !(f.shear1 * f.shear1 + f.shear2 * f.shear2 > reach * reach);
}

/// Input of the law of a contact: normal separation from the total gap, shear separation from
/// the last shear force and the step's slip.
template <class T>
CDEM_HD inline JointInput<T> contact_input(const ContactSpring<T>& spring,
                                           const ContactMotion<T>& motion,
                                           const ContactBefore<T>& before) {
  const T zero(0.0), compliance_s = spring.compliance_s();
  const T damping = -motion.dashpot * motion.gap_rate * spring.per_area();
  return {.opening = motion.gap,
          .shear1 = motion.slip1 - compliance_s * before.shear1,
          .shear2 = motion.slip2 - compliance_s * before.shear2,
          .stiffness = spring.stiffness,
          .damping = select(motion.gap < zero, damping, zero),
          .bond = zero,
          .risen = motion.stress_free_gap,
          .rate1 = motion.slip1 / T(motion.dt),
          .rate2 = motion.slip2 / T(motion.dt),
          .dt = T(motion.dt),
          .has_area = spring.has_area};
}

/// Force of a contact from the answer of its law, Eq. 13-14.
///
/// The loss in dashpot and friction is the work of their mean force in the step, as central
/// differences count it. (The new force alone with the rate, which belongs to half a step ago,
/// reads up to 8 % of an impact's energy too much.) Friction pays for the lift by dilation.
template <class T>
CDEM_HD inline ContactForce<T> contact_force(const ContactSpring<T>& spring,
                                             const ContactMotion<T>& motion,
                                             const ContactBefore<T>& before,
                                             const JointAnswer<T>& joint) {
  const T zero(0.0), half(0.5), kn = spring.n(), area = spring.area;
  const T old1 = before.shear1, old2 = before.shear2, elastic = area * joint.elastic;
  ContactForce<T> f;
  f.force_n = area * joint.normal;
  f.penetration = max_of(-motion.gap, zero) + joint.rise;
  f.shear1 = area * joint.shear1;
  f.shear2 = area * joint.shear2;
  f.energy_n = area * joint.stored_n;
  f.energy_s = area * joint.stored_s;
  f.rise = joint.rise;
  f.friction = half * spring.compliance_s() * (old1 * old1 + old2 * old2) - f.energy_s -
               half * ((old1 + f.shear1) * motion.slip1 + (old2 + f.shear2) * motion.slip2) -
               half * (kn * before.penetration + elastic) * joint.rise;
  const T braked = before.force_n - kn * before.penetration + f.force_n - elastic;
  f.dashpot = -half * braked * motion.gap_rate * T(motion.dt);
  return f;
}

}  // namespace cdem
