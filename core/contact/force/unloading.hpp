// unloading.hpp - how contacts unload: elastic, or stiffer than they load, Walton & Braun (1986);
// or along a curve.
#pragma once

#include "core/contact/force/contact_force.hpp"
#include "core/contact/force/contact_laws.hpp"

namespace cdem {

/// Effective penetration of a contact that loads with k and unloads and reloads with k / e^2: it
/// gives back the share e^2 of the energy that loading put in, whatever the masses behind it.
///
/// A contact without force that moves on outwards loses its stored penetration: it loads again from
/// where it turns.
template <class T>
CDEM_HD inline T hysteretic_penetration(T returned, T approach, T approach_before,
                                        T penetration_before) {
  const T zero(0.0);
  const T along = penetration_before + (approach - approach_before) / returned;
  return min_of(max_of(approach, zero), max_of(along, zero));
}

/// A tangential force.
template <class T>
struct ShearForce {
  T f1, f2;  // [N]
};

/// Shear force after a slip that loads with k and unloads with k / e^2.
///
/// The part of the slip along the old force unloads it; the rest of that slip, from zero force,
/// loads
/// in the opposite direction, and so does the part across. A step's work is by the mean force. So
/// that a step through zero cannot give back more than was put in, it goes on with the stiffness of
/// unloading until the force is as large as it was.
template <class T>
CDEM_HD inline ShearForce<T> hysteretic_shear(T returned, T stiffness, const ShearForce<T>& old,
                                              T slip1, T slip2) {
  const T zero(0.0), size = sqrt_of(old.f1 * old.f1 + old.f2 * old.f2);
  const T t1 = select(size > zero, old.f1 / size, zero);
  const T t2 = select(size > zero, old.f2 / size, zero);
  const T along = slip1 * t1 + slip2 * t2;  // > 0 unloads
  const T unloaded = size - stiffness / returned * along;
  const T other_way = -max_of(size, -returned * unloaded);
  const T radial = select(along > zero, max_of(unloaded, other_way), size - stiffness * along);
  return {radial * t1 - stiffness * (slip1 - along * t1),
          radial * t2 - stiffness * (slip2 - along * t2)};
}

/// Contacts that give back all that loading put in.
template <class T>
struct ElasticUnloading {
  template <class Ids>
  CDEM_HD static ElasticUnloading of(const ContactLaws&, const Ids&) {
    return {};
  }
  /// How deep a contact was one step ago.
  CDEM_HD static T depth(const ContactBefore<T>& before) { return before.penetration; }
  CDEM_HD void begin(const Truth<T>&, const T&, ContactBefore<T>&) const {}
  CDEM_HD T gap(const T& gap, const ContactBefore<T>&) const { return gap; }
  CDEM_HD T approach(const T&, const ContactForce<T>&) const { return T(0.0); }
  CDEM_HD JointInput<T> input(const ContactSpring<T>& spring, const ContactMotion<T>& motion,
                              const ContactBefore<T>& before) const {
    return contact_input(spring, motion, before);
  }
  CDEM_HD ContactForce<T> force(const ContactSpring<T>& spring, const ContactMotion<T>& motion,
                                const T&, const ContactBefore<T>& before,
                                const JointAnswer<T>& joint) const {
    return contact_force(spring, motion, before, joint);
  }
  CDEM_HD T dashpot(const T& c) const { return c; }
  /// Largest stiffness  [N/m].
  CDEM_HD T stiffness(const ContactSpring<T>& spring) const {
    return max_of(spring.n(), spring.s());
  }
};

/// Contacts of which some return less energy, or have a curved normal spring. `returned` is
/// e^2, the square of the coefficient of restitution; where it is 1 the contact is elastic, to the
/// bit. The effective penetration of a curved spring is that of a straight one with the same force.
template <class T>
struct HystereticUnloading {
  T returned_n, returned_s;
  Truth<T> curved = T(0.0) > T(0.5);

  template <class Ids>
  CDEM_HD static HystereticUnloading of(const ContactLaws& laws, const Ids& interface) {
    return {laws.faces.returned_n(interface), laws.faces.returned_s(interface),
            laws.interfaces.closes_by_curve(interface)};
  }
  CDEM_HD static T depth(const ContactBefore<T>& before) { return max_of(before.approach, T(0.0)); }
  /// A contact that begins, or goes on on another face, was no deeper than it is there: as much of
  /// its approach as it has, and the same part of its penetration.
  CDEM_HD void begin(const Truth<T>& changes, const T& approach, ContactBefore<T>& before) const {
    const T zero(0.0), was = depth(before), now = min_of(max_of(approach, zero), was);
    const T part = select(was > zero, now / was, zero);
    before.approach = select(changes, now, before.approach);
    before.penetration = select(changes, part * before.penetration, before.penetration);
  }
  /// The gap that the law is asked with, from that past the stress-free gap.
  CDEM_HD T gap(const T& gap, const ContactBefore<T>& before) const {
    const T zero(0.0);
    const T q = hysteretic_penetration(returned_n, -gap, before.approach, before.penetration);
    return select((returned_n < T(1.0)) & (gap < zero), -q, gap);
  }
  /// The loss of a contact with restitution is known already.
  CDEM_HD T dashpot(const T& c) const { return select(returned_n < T(1.0), T(0.0), c); }
  /// The approach that is kept for the next step.
  CDEM_HD T approach(const T& gap, const ContactForce<T>& f) const { return f.rise - gap; }

  CDEM_HD JointInput<T> input(const ContactSpring<T>& spring, const ContactMotion<T>& motion,
                              const ContactBefore<T>& before) const {
    JointInput<T> in = contact_input(spring, motion, before);
    const ShearForce<T> trial = hysteretic_shear(
        returned_s, spring.s(), {before.shear1, before.shear2}, motion.slip1, motion.slip2);
    const auto recoils = returned_s < T(1.0);
    in.shear1 = select(recoils, -spring.compliance_s() * trial.f1, in.shear1);
    in.shear2 = select(recoils, -spring.compliance_s() * trial.f2, in.shear2);
    return in;
  }
  /// Energy that the contact does not return is lost: in the normal direction with the dashpot, in
  /// shear with friction. `gap` is that past the stress-free gap. A contact that opens pushes no
  /// further than until it is free of stress.
  CDEM_HD ContactForce<T> force(const ContactSpring<T>& spring, const ContactMotion<T>& motion,
                                const T& gap, const ContactBefore<T>& before,
                                const JointAnswer<T>& joint) const {
    const T zero(0.0), half(0.5), one(1.0);
    ContactForce<T> f = contact_force(spring, motion, before, joint);
    f.penetration = select(curved, spring.stiffness.compliance_n * joint.elastic, f.penetration);
    const T old_s = half * spring.compliance_s() *
                    (before.shear1 * before.shear1 + before.shear2 * before.shear2);
    f.friction -= (one - returned_s) * (old_s - f.energy_s);
    f.energy_n = returned_n * f.energy_n;
    f.energy_s = returned_s * f.energy_s;
    const T moved = max_of(-gap, zero) - max_of(before.approach, zero);
    const T inwards = max_of(moved, -returned_n * before.penetration) + f.rise;
    const T kept = inwards - returned_n * (f.penetration - before.penetration);
    const T mean = half * (spring.n() * before.penetration + spring.area * joint.elastic);
    f.dashpot += select(returned_n < one, mean * max_of(kept, zero), zero);
    return f;
  }
  CDEM_HD T stiffness(const ContactSpring<T>& spring) const {
    return max_of(spring.n() / returned_n, spring.s() / returned_s);
  }
};

}  // namespace cdem
