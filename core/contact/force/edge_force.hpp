// edge_force.hpp - forces of semi-edges in contact.
#pragma once

#include "core/contact/force/contact_force.hpp"
#include "core/contact/force/contact_laws.hpp"
#include "core/contact/geometry/edge.hpp"
#include "core/contact/narrow_phase/contact_columns.hpp"

namespace cdem {

/// Force of every semi-edge contact.
struct UpdateEdgeForces {
  FaceColumns faces;
  FaceGeometry geometry;
  const Index* exposed_face;
  ContactLaws laws;
  const Real* state_before;  // rows of ContactState, one step ago
  EdgeColumns edges;

  template <class I>
  CDEM_HD void operator()(I item) const {
    using T = Number<I>;
    const auto kept = [&](auto of) {
      return indices_of([&](Index p) { return of(EdgeContact::at(edges.contact, p)); }, item);
    };
    const auto mother = kept([](const EdgeContact& c) { return c.mother; });
    const auto t = kept([](const EdgeContact& c) { return c.face; });
    const auto edge = kept([](const EdgeContact& c) { return c.edge; });
    const auto before = kept([](const EdgeContact& c) { return c.before; });
    const auto m = indices_of([](Index side) { return side / 4; }, mother);
    const auto m0 =
        indices_of([&](Index s) { return geometry.table[s / 4].corner[s % 4]; }, mother);
    const auto m1 = indices_of([&](Index s) { return geometry.table[s / 4].end(s % 4); }, mother);
    // the frame belongs to the edge, whichever of its faces is the right one just now
    const auto t0 = indices_of([&](Index e) { return faces.edge_nodes[2 * e]; }, edge);
    const auto t1 = indices_of([&](Index e) { return faces.edge_nodes[2 * e + 1]; }, edge);
    const Vec3<T> out = geometry.normal(t) - geometry.normal(m);
    const auto was = [&](auto of) {  // one step ago
      return numbers_of(
          [&](Index b) {
            return of(b >= 0 ? ContactState::at(state_before, b)
                             : ContactState{0, -1, 0, 0, 0, 0, 0});
          },
          before);
    };
    const T penetration = was([](const ContactState& s) { return s.penetration; });
    const T stress_free_gap = was([](const ContactState& s) { return s.stress_free_gap; });
    const auto law = laws.between(geometry, m, t);
    // A_SE of Eq. 5, and a half of it because the other block's semi-edges see the crossing too
    const auto [kn, ks] = laws.stiffness(geometry, law, m, t);
    const T tan_friction =
        numbers_of([&](Index l) { return laws.interfaces[l].tan_friction; }, law);

    const InMotion& nodes = faces.nodes;
    const T dt(faces.dt), zero(0.0), one(1.0);
    const Vec3<T> xm = nodes.position(m0), xt = nodes.position(t0);
    const Vec3<T> xm1 = nodes.position(m1), xt1 = nodes.position(t1);
    const Vec3<T> dm = xm1 - xm, along_t = xt1 - xt;
    const Frame<T> frame = edge_frame(edge_normal(dm, along_t, out), along_t);
    const Crossing<T> c = cross_edges(xm, dm, xt, along_t, frame.n);

    const Vec3<T> vm = nodes.velocity(m0), vt = nodes.velocity(t0);
    const Vec3<T> vm1 = nodes.velocity(m1), vt1 = nodes.velocity(t1);
    const Vec3<T> om = xm - dt * vm, ot = xt - dt * vt;  // one step ago
    const Vec3<T> old_dm = (xm1 - dt * vm1) - om, old_along = (xt1 - dt * vt1) - ot;
    const Frame<T> old = edge_frame(edge_normal(old_dm, old_along, out), old_along);
    const Vec3<T> apart = (om + c.s * old_dm) - (ot + c.t * old_along);
    const Vec3<T> rate = (vm + c.s * (vm1 - vm)) - (vt + c.t * (vt1 - vt));
    const T inverse_mass = inverse_mass_of(m0, m1, c.s) + inverse_mass_of(t0, t1, c.t);
    const T dashpot = T(2.0 * laws.damping_ratio) * sqrt_of(kn / inverse_mass);
    const T gap_rate = dot(frame.n, rate);
    const T free =
        select(penetration < zero, starting_stress_free_gap(c.gap, gap_rate, dt, zero, zero),
               lifted_stress_free_gap(stress_free_gap, c.gap));
    const ContactBefore<T> old_force{was([](const ContactState& s) { return s.force_n; }),
                                     max_of(penetration, zero),
                                     was([](const ContactState& s) { return s.shear1; }),
                                     was([](const ContactState& s) { return s.shear2; })};
    const ContactForce<T> f =
        contact_force(kn, ks, tan_friction, c.gap - free, gap_rate, dashpot, -dot(old.t1, apart),
                      -dot(old.t2, apart), old_force, Dilation<T>{zero, zero}, dt);

    const Vec3<T> force = f.force_n * frame.n + f.shear1 * frame.t1 + f.shear2 * frame.t2;
    // both edges take the force on one line of action: no couple is left over
    const Crossing<T> line = cross_edges(xm, dm, xt, along_t, force);
    const auto pressed = f.force_n > zero;
    const T on_m = select(pressed, line.s, c.s), on_t = select(pressed, line.t, c.t);
    const T forward = numbers_of(  // does the target face's side go the way of the edge?
        [&](Index x, Index e, Index start) {
          const Index face = exposed_face[x];
          return faces.vertex(face, faces.side_on(face, e)) == start;
        },
        t, edge, t0);
    const T state[8] = {f.force_n, f.penetration, f.shear1,   f.shear2,
                        free,      f.energy_n,    f.energy_s, zero};
    const T reaction[8] = {force.x,    force.y,
                           force.z,    select(pressed, max_of(kn, ks), zero),
                           on_m,       select(forward > zero, on_t, one - on_t),
                           f.friction, f.dashpot};
    set_rows(edges.state, item, state);
    set_rows(edges.reaction, item, reaction);
  }

 private:
  template <class Ids, class T>
  CDEM_HD T inverse_mass_of(const Ids& a, const Ids& b, const T& s) const {
    const T rest = T(1.0) - s;
    return rest * rest / look_up(laws.node_mass, a) + s * s / look_up(laws.node_mass, b);
  }
};

}  // namespace cdem
