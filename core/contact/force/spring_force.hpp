// spring_force.hpp - forces of semi-springs in contact.
#pragma once

#include "core/contact/force/contact_force.hpp"
#include "core/contact/force/contact_laws.hpp"
#include "core/contact/force/mother_point.hpp"
#include "core/contact/force/unloading.hpp"
#include "core/contact/narrow_phase/contact_columns.hpp"
#include "core/interfaces/history.hpp"

namespace cdem {

/// Force of every semi-spring in contact; slot = 4 * exposed face + vertex. Run by WithLaws.
template <template <class> class Unloading>
struct UpdateSpringForces {
  FaceColumns faces;
  FaceGeometry geometry;
  SearchRules rules;
  ContactLaws laws;
  SpringColumns springs;
  HistoryRows history;  // [slot]

  CDEM_HD Range items(Index m) const { return {4 * m, 4 * m + 4}; }
  CDEM_HD bool selects(Index, Index slot) const { return springs.target[slot] >= 0; }

  template <class Laws, class I>
  CDEM_HD void update(const I& item) const {
    using T = Number<I>;
    const T zero(0.0);
    const auto& slot = item.id;
    const Target<I> target = target_of(item);
    const auto pair = relative_motion(item, target);
    const auto interface = laws.between(geometry, item.row, target.face);
    ContactSpring<T> spring = laws.spring(geometry, interface, item.row, target.face);
    spring.area = T(0.5) * spring.area;  // the other block's semi-springs see the contact too
    const auto unloading = Unloading<T>::of(laws, interface);
    Before<T> old = before(slot, target.begins);
    laws.template take_true_area<Laws>(spring, geometry, interface, item.row, target.face,
                                       old.force.penetration > zero);
    const T gap = pair.foot.gap, dt(faces.dt);
    const T free =
        select(target.changes,
               starting_stress_free_gap(gap, pair.gap_rate, dt, unloading.depth(old.force),
                                        max_of(old.stress_free_gap, zero)),
               lifted_stress_free_gap(old.stress_free_gap, gap));
    unloading.begin(target.changes, free - (gap - pair.gap_rate * dt), old.force);
    const ContactMotion<T> motion{
        .gap = unloading.gap(gap - free, old.force),
        .stress_free_gap = free,
        .gap_rate = pair.gap_rate,
        .slip1 = pair.slip1,
        .slip2 = pair.slip2,
        .dashpot = unloading.dashpot(laws.dashpot(spring, pair.inverse_mass)),
        .dt = faces.dt};
    const JointAnswer<T> joint = respond_with_history<Laws>(
        laws.interfaces, interface, unloading.input(spring, motion, old.force), history, slot,
        history, slot);
    const ContactForce<T> f = unloading.force(spring, motion, gap - free, old.force, joint);
    const T state[8] = {
        f.force_n,     f.penetration, f.shear1,   f.shear2,
        free + f.rise, f.energy_n,    f.energy_s, unloading.approach(gap - free, f)};
    set_rows(springs.state, slot, state);
    count_losses(slot, target.changes & !target.begins, old, f, motion);
    write_reaction(slot, pair, unloading.stiffness(spring), f);
  }

 private:
  /// The target of a semi-spring, and whether it is new.
  template <class I>
  struct Target {
    typename IndexOf<I>::type face;
    Truth<Number<I>> changes;  // the contact begins, or moved to this face
    Truth<Number<I>> begins;
  };
  template <class I>
  CDEM_HD Target<I> target_of(const I& item) const {
    using T = Number<I>;
    const auto face = look_up(springs.target, item.id);
    const auto before = look_up(springs.target_before, item.id);
    const auto begins = numbers_of([](Index b) { return b < 0; }, before) > T(0.0);
    return {face, differ(face, before), begins};
  }

  /// Energy of the slot one step ago; zero for a new contact.
  template <class T>
  struct Before {
    ContactBefore<T> force;
    T stress_free_gap;
    T undelivered_n, undelivered_s;  // of a contact that moved, see ChangeTargets  [J]
  };
  template <class Ids, class T = Number<Ids>>
  CDEM_HD Before<T> before(const Ids& slot, const Truth<T>& begins) const {
    const T zero(0.0);
    const Four<T> forces = InRows{springs.state}.at(slot, 0);
    const Four<T> rest = InRows{springs.state}.at(slot, 4);
    return {.force = {.force_n = select(begins, zero, forces.x),
                      .penetration = select(begins, zero, forces.y),
                      .shear1 = select(begins, zero, forces.z),
                      .shear2 = select(begins, zero, forces.w),
                      .approach = select(begins, zero, rest.w)},
            .stress_free_gap = select(begins, zero, rest.x),
            .undelivered_n = rest.y,
            .undelivered_s = rest.z};
  }

  /// How the acting point moves against the target in the step.
  template <class T>
  struct RelativeMotion {
    FaceShape<T> shape;
    Frame<T> frame;
    Vec3<T> mother;  // acting point
    Projection<T> foot;
    T gap_rate, slip1, slip2;
    T inverse_mass;  // of both points: sum w^2 / m  [1/kg]
  };
  template <class I>
  CDEM_HD RelativeMotion<Number<I>> relative_motion(const I& item, const Target<I>& target) const {
    using T = Number<I>;
    const T dt(faces.dt);
    const auto corners = geometry.vertices(target.face);
    const FaceShape<T> shape = faces.shape(corners);
    const Frame<T> frame = shape.frame(geometry.normal(target.face));
    const auto mother = MotherPoint<T>::at(faces, geometry, rules, springs.rim_action,
                                           laws.node_mass, item.row, item.id);
    const Projection<T> foot = project(shape, mother.x, frame.n);
    FaceShape<T> old_shape = shape;  // one step ago
    Vec3<T> velocity[4];
    for (Index j = 0; j < 4; ++j) {
      velocity[j] = faces.nodes.velocity(corners.node[j]);
      old_shape.x[j] = shape.x[j] - dt * velocity[j];
    }
    const Frame<T> old_frame = old_shape.frame();
    Vec3<T> apart = mother.x_old, rate = mother.v;
    T inverse_mass = mother.inverse_mass;
    for (Index j = 0; j < 4; ++j) {
      apart = apart - foot.weight[j] * old_shape.x[j];
      rate = rate - foot.weight[j] * velocity[j];
      inverse_mass += foot.weight[j] * foot.weight[j] / look_up(laws.node_mass, corners.node[j]);
    }
    return {.shape = shape,
            .frame = frame,
            .mother = mother.x,
            .foot = foot,
            .gap_rate = dot(frame.n, rate),
            .slip1 = -dot(old_frame.t1, apart),
            .slip2 = -dot(old_frame.t2, apart),
            .inverse_mass = inverse_mass};
  }

  /// A move loses what the springs held on the old face and neither gave back nor hold on the new
  /// one. If it should make energy, that is no loss: it is left to the closing error.
  template <class Ids, class T>
  CDEM_HD void count_losses(const Ids& slot, const Truth<T>& moves, const Before<T>& old,
                            const ContactForce<T>& f, const ContactMotion<T>& motion) const {
    const T half(0.5);
    const T lost_s =
        old.undelivered_s - f.energy_s - half * (f.shear1 * motion.slip1 + f.shear2 * motion.slip2);
    const T lost_n =
        old.undelivered_n - f.energy_n - half * f.force_n * motion.gap_rate * T(motion.dt);
    add_to(springs.friction, slot, select(moves, lost_s, f.friction));
    add_to(springs.dashpot, slot, select(moves, max_of(lost_n, -lost_s), f.dashpot));
  }

  /// The target takes the force where its line of action meets the face: no couple is left over.
  template <class Ids, class T>
  CDEM_HD void write_reaction(const Ids& slot, const RelativeMotion<T>& pair, const T& stiffness,
                              const ContactForce<T>& f) const {
    const T zero(0.0);
    const Frame<T>& frame = pair.frame;
    const Vec3<T> force = f.force_n * frame.n + f.shear1 * frame.t1 + f.shear2 * frame.t2;
    const auto pressed = f.force_n > zero;
    const auto meets = meets_target(f);
    const T lever = select(meets, pair.foot.gap / f.force_n, zero);
    const Projection<T> meet = project(pair.shape, pair.mother - lever * force, frame.n);
    const auto weight = [&](Index j) { return select(meets, meet.weight[j], pair.foot.weight[j]); };
    const T reaction[8] = {force.x,   force.y,   force.z,   select(pressed, stiffness, zero),
                           weight(0), weight(1), weight(2), weight(3)};
    set_rows(springs.reaction, slot, reaction);
  }
};

}  // namespace cdem
