// bond_point.hpp - one bond point: a spring between two faces until it breaks. Feng et al. (2014),
// Eq. 13-14.
#pragma once

#include "core/contact/geometry/face.hpp"
#include "core/interfaces/closure.hpp"

namespace cdem {

/// History of one bond point that every law has. While it is intact the slip stays zero, unless the
/// law has state.
template <class T>
struct BondHistory {
  T bond;           // 1 while intact, then 0
  T slip1, slip2;   // plastic slip in the pair's frame  [m]
  T rise = T(0.0);  // by dilation  [m]
};

/// How fast a joint slips, along the tangents of its frame  [m/s].
template <class T>
struct SlipRate {
  T along1, along2;
  T dt = T(0.0);  // of the step that it is of; 0 at rest  [s]
};

/// Spring of one bond point: its share of the true overlap area, so that strength does not depend
/// on which side is meshed finer, and the interface's stiffness.
template <class T>
struct BondSpring {
  T area;  // [m2]
  JointStiffness<T> stiffness;

  /// Input of the law for a jump of displacement x_b - x_a, without the rise of the point.
  CDEM_HD JointInput<T> input(const Frame<T>& frame, const Vec3<T>& jump, const BondHistory<T>& h,
                              const SlipRate<T>& rate) const {
    return {.opening = dot(frame.n, jump),
            .shear1 = dot(frame.t1, jump) - h.slip1,
            .shear2 = dot(frame.t2, jump) - h.slip2,
            .stiffness = stiffness,
            .damping = T(0.0),
            .bond = h.bond,
            .risen = h.rise,
            .rate1 = rate.along1,
            .rate2 = rate.along2,
            .dt = rate.dt,
            .has_area = T(1.0)};
  }
  /// The same at rest.
  CDEM_HD JointInput<T> input(const Frame<T>& frame, const Vec3<T>& jump,
                              const BondHistory<T>& h) const {
    return input(frame, jump, h, {T(0.0), T(0.0)});
  }
  /// The same of an intact point.
  CDEM_HD JointInput<T> input(const Frame<T>& frame, const Vec3<T>& jump) const {
    return input(frame, jump, {.bond = T(1.0), .slip1 = T(0.0), .slip2 = T(0.0)});
  }
};

/// Results of a bond point in a step.
template <class T>
struct BondForce {
  Vec3<T> on_b;          // force on the second face  [N]
  T stored;              // elastic energy  [J]
  T fracture, friction;  // energy lost in this step  [J]
  T tension, shear;      // 1 when the bond broke in this step, by that cause
};

/// Does an intact bond point bear this jump? Then `on_b` is the force that bond_force gives, and
/// the history stays as it is. `Laws` are JointLaws, here and below.
template <class Laws, class T>
CDEM_HD inline auto bears(const Laws& laws, const BondSpring<T>& spring, const Frame<T>& frame,
                          const Vec3<T>& jump, const T* state, Vec3<T>& on_b) {
  const Borne<T> joint = laws.bears(spring.input(frame, jump), state);
  on_b = spring.area * (joint.normal * frame.n + joint.shear1 * frame.t1 + joint.shear2 * frame.t2);
  return joint.holds;
}

/// Elastic energy of a bond point that bears this jump  [J].
template <class Laws, class T>
CDEM_HD inline T intact_energy(const Laws& laws, const BondSpring<T>& spring, const Frame<T>& frame,
                               const Vec3<T>& jump, const T* state) {
  return spring.area * laws.bears(spring.input(frame, jump), state).stored;
}

/// Tractions of one step ago, without asking for limits again, which a stage may have changed: a
/// law without state was elastic, and the slip of a broken point makes the elastic law give the
/// limited traction.
template <class Laws, class T>
CDEM_HD inline JointAnswer<T> before_step(const Laws& laws, const JointInput<T>& in, T* state) {
  const T zero(0.0), half(0.5);
  const JointStiffness<T>& k = in.stiffness;
  JointAnswer<T> was{};
  was.normal = -k.n * in.opening;
  was.shear1 = -k.s * in.shear1;
  was.shear2 = -k.s * in.shear2;
  const auto broken = in.bond < half;
  was.normal = select(broken, max_of(was.normal, zero), was.normal);
  const auto open = broken & !(was.normal > zero);
  was.shear1 = select(open, zero, was.shear1);
  was.shear2 = select(open, zero, was.shear2);
  was.stored_n = half * k.compliance_n * was.normal * was.normal;
  was.stored_s = half * k.compliance_s * (was.shear1 * was.shear1 + was.shear2 * was.shear2);
  if constexpr (Laws::most_state > 0) {
    if (laws.table.curved != 0) {
      const auto curved = broken & laws.table.closes_by_curve(laws.interface);
      const Closure<T> closed = laws.close(max_of(-in.opening, zero), k);
      was.normal = select(curved, closed.pressure, was.normal);
      was.stored_n = select(curved, closed.stored, was.stored_n);
    }
    was = select(laws.remember() & !broken, laws.respond(in, state), was);
  }
  return was;
}

/// Force of one bond point from the jump of displacement x_b - x_a across it, Eq. 13-14.
///
/// The force is total, not incremental: F_n = -K_n n.jump, F_s = -K_s (t.jump - slip), so it cannot
/// drift and needs no history until it slips. A point that broke but whose pair is not yet released
/// to the search goes on as a frictional contact at the same place; in an open hinge (`searched`),
/// whose faces the search has already, it carries nothing.
/// `jump` excludes the rise of the point. `jump_old`, the same one step ago, serves only the
/// energy ledger: the loss is U_old - U_new + work done on the spring by the mean force. While
/// a bond holds, its law gives the loss. `state` is the state of the law.
template <class Laws, class T, class M>
CDEM_HD inline BondForce<T> bond_force(const Laws& laws, const BondSpring<T>& spring,
                                       const Frame<T>& frame, const Vec3<T>& jump,
                                       const Vec3<T>& jump_old, Real dt, const M& searched,
                                       BondHistory<T>& h, T* state) {
  const T zero(0.0), one(1.0), half(0.5);
  const Vec3<T> moved = jump - jump_old;
  const SlipRate<T> rate{dot(frame.t1, moved) / T(dt), dot(frame.t2, moved) / T(dt), T(dt)};
  const auto input_at = [&](const Vec3<T>& x) { return spring.input(frame, x, h, rate); };
  constexpr Index size = Laws::most_state;
  T state_old[size + 1];
  for (Index k = 0; k < size; ++k) state_old[k] = state[k];

  const T before = h.bond;
  const JointAnswer<T> now = laws.respond(input_at(jump), state);
  const auto intact = now.bond > half;
  const auto carries = intact | !searched;
  const T normal = select(carries, now.normal, zero);
  const T shear1 = select(carries, now.shear1, zero), shear2 = select(carries, now.shear2, zero);
  const T stored_n = select(carries, now.stored_n, zero),
          stored_s = select(carries, now.stored_s, zero);

  BondForce<T> out;
  const auto broke = before > now.bond;
  out.tension = select(broke & now.opens, one, zero);
  out.shear = select(broke, one, zero) - out.tension;
  out.stored = spring.area * (stored_n + stored_s);
  out.fracture = spring.area * now.fracture;
  out.friction = zero;
  if constexpr (Laws::most_state > 0) out.friction = spring.area * now.friction;
  if (any_of(!intact)) {
    const JointAnswer<T> was = before_step(laws, input_at(jump_old), state_old);
    const T work_n = (was.normal + normal) * dot(frame.n, moved);
    const T work_s =
        (was.shear1 + shear1) * dot(frame.t1, moved) + (was.shear2 + shear2) * dot(frame.t2, moved);
    const T lost_n = was.stored_n - stored_n - half * work_n;
    const T lost_s = was.stored_s - stored_s - half * work_s;
    out.fracture = select(broke, spring.area * (lost_n + lost_s) - out.friction, out.fracture);
    out.friction = select((!broke) & (!intact) & carries, spring.area * lost_s, out.friction);
    // friction pays for the lift by dilation, see contact_force
    const auto rises = now.rise > zero;
    if (any_of(rises)) {
      const T lift = half * spring.area * (was.normal + normal) * now.rise;
      out.friction -= select(rises & (!broke) & carries, lift, zero);
      h.rise += select(carries, now.rise, zero);
    }
  }
  // the slip that makes the elastic law give the limited force
  auto rests = intact;
  if constexpr (Laws::most_state > 0) rests = rests & !laws.remember();
  const T along1 = dot(frame.t1, jump), along2 = dot(frame.t2, jump);
  h.slip1 = select(rests, h.slip1, along1 + shear1 * spring.stiffness.compliance_s);
  h.slip2 = select(rests, h.slip2, along2 + shear2 * spring.stiffness.compliance_s);
  h.bond = now.bond;
  out.on_b = spring.area * (normal * frame.n + shear1 * frame.t1 + shear2 * frame.t2);
  return out;
}

}  // namespace cdem
