// edge_force.hpp - forces of semi-edges in contact.
#pragma once

#include "core/contact/force/contact_force.hpp"
#include "core/contact/force/contact_laws.hpp"
#include "core/contact/force/unloading.hpp"
#include "core/contact/geometry/edge.hpp"
#include "core/contact/narrow_phase/contact_columns.hpp"
#include "core/interfaces/history.hpp"

namespace cdem {

/// Force of every semi-edge contact. Run by WithLaws.
template <template <class> class Unloading>
struct UpdateEdgeForces {
  FaceColumns faces;
  FaceGeometry geometry;
  ContactLaws laws;
  const Real* state_before;  // rows of ContactState, one step ago
  EdgeColumns edges;
  HistoryRows side_history;     // [4 * exposed face + side]
  HistoryRows contact_history;  // [contact], see MergeSideHistories

  template <class Laws, class I>
  CDEM_HD void update(const I& item) const {
    using T = Number<I>;
    const T zero(0.0);
    const auto contact = contact_of(item);
    const auto interface = laws.between(geometry, contact.mother_face, contact.target_face);
    // A_SE of Eq. 5, and a half of it because the other block's semi-edges see the crossing too
    ContactSpring<T> spring =
        laws.spring(geometry, interface, contact.mother_face, contact.target_face);
    const auto pair = relative_motion(contact);
    const auto unloading = Unloading<T>::of(laws, interface);
    const Before<T> old = before(contact.before);
    laws.template take_true_area<Laws>(spring, geometry, interface, contact.mother_face,
                                       contact.target_face, old.force.penetration > zero);
    const T gap = pair.crossing.gap;
    const T free =
        select(old.begins, starting_stress_free_gap(gap, pair.gap_rate, T(faces.dt), zero, zero),
               lifted_stress_free_gap(old.stress_free_gap, gap));
    const ContactMotion<T> motion{
        .gap = unloading.gap(gap - free, old.force),
        .stress_free_gap = free,
        .gap_rate = pair.gap_rate,
        .slip1 = pair.slip1,
        .slip2 = pair.slip2,
        .dashpot = unloading.dashpot(laws.dashpot(spring, pair.inverse_mass)),
        .dt = faces.dt};
    const auto place = indices_of([](Index c) { return c; }, item);
    const JointAnswer<T> joint = respond_with_history<Laws>(
        laws.interfaces, interface, unloading.input(spring, motion, old.force), side_history,
        contact.mother_side, contact_history, place);
    const ContactForce<T> f = unloading.force(spring, motion, gap - free, old.force, joint);
    const T state[8] = {
        f.force_n,     f.penetration, f.shear1,   f.shear2,
        free + f.rise, f.energy_n,    f.energy_s, unloading.approach(gap - free, f)};
    set_rows(edges.state, item, state);
    write_reaction(item, contact, pair, unloading.stiffness(spring), f);
  }

 private:
  /// The two sides of a contact.
  template <class Ids>
  struct Contact {
    Ids mother_side;  // 4 * exposed face + side
    Ids mother_face, target_face;
    Ids target_edge;
    Ids before;  // place one step ago, or -1
    Ids m0, m1;  // ends of the mother side
    Ids t0, t1;  // and of the target edge: the frame belongs to it, whichever of its faces is
                 // the right one just now
  };
  template <class I>
  CDEM_HD auto contact_of(const I& item) const {
    using Ids = typename IndexOf<I>::type;
    const auto kept = [&](auto of) {
      return indices_of([&](Index p) { return of(EdgeContact::at(edges.contact, p)); }, item);
    };
    Contact<Ids> c;
    c.mother_side = kept([](const EdgeContact& e) { return e.mother; });
    c.target_face = kept([](const EdgeContact& e) { return e.face; });
    c.target_edge = kept([](const EdgeContact& e) { return e.edge; });
    c.before = kept([](const EdgeContact& e) { return e.before; });
    c.mother_face = indices_of([](Index side) { return side / 4; }, c.mother_side);
    c.m0 = indices_of([&](Index s) { return geometry.table[s / 4].corner[s % 4]; }, c.mother_side);
    c.m1 = indices_of([&](Index s) { return geometry.table[s / 4].end(s % 4); }, c.mother_side);
    c.t0 = indices_of([&](Index e) { return faces.edge_nodes[2 * e]; }, c.target_edge);
    c.t1 = indices_of([&](Index e) { return faces.edge_nodes[2 * e + 1]; }, c.target_edge);
    return c;
  }

  /// Its energy one step ago; zero for a new contact.
  template <class T>
  struct Before {
    ContactBefore<T> force;
    T stress_free_gap;
    Truth<T> begins;
  };
  template <class Ids, class T = Number<Ids>>
  CDEM_HD Before<T> before(const Ids& place) const {
    Real none[8];
    ContactState::none().store(none, 0);
    const Four<T> forces = InRows{state_before}.at(place, 0, none);
    const Four<T> rest = InRows{state_before}.at(place, 4, none);
    const T zero(0.0);
    return {.force = {.force_n = forces.x,
                      .penetration = max_of(forces.y, zero),
                      .shear1 = forces.z,
                      .shear2 = forces.w,
                      .approach = rest.w},
            .stress_free_gap = rest.x,
            .begins = forces.y < zero};
  }

  /// How the two edges move against each other in the step.
  template <class T>
  struct RelativeMotion {
    Vec3<T> mother, mother_along, target, target_along;
    Frame<T> frame;
    Crossing<T> crossing;
    T gap_rate, slip1, slip2;
    T inverse_mass;  // of both points: sum w^2 / m  [1/kg]
  };
  template <class Ids>
  CDEM_HD RelativeMotion<Number<Ids>> relative_motion(const Contact<Ids>& contact) const {
    using T = Number<Ids>;
    const InMotion& nodes = faces.nodes;
    const T dt(faces.dt);
    const Vec3<T> out = geometry.normal(contact.target_face) - geometry.normal(contact.mother_face);
    const Vec3<T> xm = nodes.position(contact.m0), xt = nodes.position(contact.t0);
    const Vec3<T> xm1 = nodes.position(contact.m1), xt1 = nodes.position(contact.t1);
    const Vec3<T> along_m = xm1 - xm, along_t = xt1 - xt;
    const Frame<T> frame = edge_frame(edge_normal(along_m, along_t, out), along_t);
    const Crossing<T> c = cross_edges(xm, along_m, xt, along_t, frame.n);
    const Vec3<T> vm = nodes.velocity(contact.m0), vt = nodes.velocity(contact.t0);
    const Vec3<T> vm1 = nodes.velocity(contact.m1), vt1 = nodes.velocity(contact.t1);
    const Vec3<T> om = xm - dt * vm, ot = xt - dt * vt;  // one step ago
    const Vec3<T> old_m = (xm1 - dt * vm1) - om, old_t = (xt1 - dt * vt1) - ot;
    const Frame<T> old = edge_frame(edge_normal(old_m, old_t, out), old_t);
    const Vec3<T> apart = (om + c.s * old_m) - (ot + c.t * old_t);
    const Vec3<T> rate = (vm + c.s * (vm1 - vm)) - (vt + c.t * (vt1 - vt));
    return {.mother = xm,
            .mother_along = along_m,
            .target = xt,
            .target_along = along_t,
            .frame = frame,
            .crossing = c,
            .gap_rate = dot(frame.n, rate),
            .slip1 = -dot(old.t1, apart),
            .slip2 = -dot(old.t2, apart),
            .inverse_mass = inverse_mass_of(contact.m0, contact.m1, c.s) +
                            inverse_mass_of(contact.t0, contact.t1, c.t)};
  }
  template <class Ids, class T>
  CDEM_HD T inverse_mass_of(const Ids& a, const Ids& b, const T& s) const {
    const T rest = T(1.0) - s;
    return rest * rest / look_up(laws.node_mass, a) + s * s / look_up(laws.node_mass, b);
  }

  /// Both edges take the force on one line of action: no couple is left over.
  template <class I, class Ids, class T>
  CDEM_HD void write_reaction(const I& item, const Contact<Ids>& contact,
                              const RelativeMotion<T>& pair, const T& stiffness,
                              const ContactForce<T>& f) const {
    const T zero(0.0), one(1.0);
    const Frame<T>& frame = pair.frame;
    const Vec3<T> force = f.force_n * frame.n + f.shear1 * frame.t1 + f.shear2 * frame.t2;
    const Crossing<T> line =
        cross_edges(pair.mother, pair.mother_along, pair.target, pair.target_along, force);
    const auto pressed = f.force_n > zero;
    const auto meets = meets_target(f);
    const T on_m = select(meets, line.s, pair.crossing.s);
    const T on_t = select(meets, line.t, pair.crossing.t);
    // does the target face's side have the direction of the edge?
    const auto same_way = [&](Index x, Index start, Index end) {
      const Index* v = geometry.table[x].corner;
      const auto side = [&](Index a, Index b) { return int(v[a] == start) & int(v[b] == end); };
      return side(0, 1) | side(1, 2) | side(2, 3) | side(3, 0);  // of a triangle v[3] is v[2]
    };
    const T forward = numbers_of(same_way, contact.target_face, contact.t0, contact.t1);
    const T reaction[8] = {force.x,    force.y,
                           force.z,    select(pressed, stiffness, zero),
                           on_m,       select(forward > zero, on_t, one - on_t),
                           f.friction, f.dashpot};
    set_rows(edges.reaction, item, reaction);
  }
};

/// Give each side of an exposed face the history that its contacts wrote. Where one side crosses
/// several edges, they share it: the largest number of each variable goes on.
struct MergeSideHistories {
  EdgeColumns edges;
  HistoryRows side_history, contact_history;

  CDEM_HD void operator()(One m) const {
    constexpr Index width = HistoryRows::width;
    for (Index c = edges.first[m.i]; c < edges.first[m.i + 1]; ++c) {
      const Index side = EdgeContact::at(edges.contact, c).mother;
      const bool shares = c > edges.first[m.i] &&
                          EdgeContact::at(edges.contact, c - 1).mother == side &&
                          contact_history.law[c - 1] == contact_history.law[c];
      Real* to = side_history.rows + std::size_t(side) * width;
      const Real* from = contact_history.rows + std::size_t(c) * width;
      for (Index k = 0; k < width; ++k) to[k] = shares ? max_of(to[k], from[k]) : from[k];
      side_history.law[side] = contact_history.law[c];
    }
  }
};

}  // namespace cdem
