// spring_force.hpp - forces of semi-springs in contact.
#pragma once

#include "core/contact/force/contact_force.hpp"
#include "core/contact/force/contact_laws.hpp"
#include "core/contact/narrow_phase/closed_contact.hpp"
#include "core/contact/narrow_phase/contact_columns.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// Force of every semi-spring in contact; slot = 4 * exposed face + vertex.
struct UpdateSpringForces {
  FaceColumns faces;
  FaceGeometry geometry;
  SearchRules rules;
  ContactLaws laws;
  SpringColumns springs;

  CDEM_HD Range items(Index m) const { return {4 * m, 4 * m + 4}; }
  /// Slots that are in contact; those that no longer are end here.
  CDEM_HD bool selects(Index m, Index slot) const {
    const Index t = springs.target[slot], before = springs.target_before[slot];
    if (before >= 0 && t != before) {
      if (t < 0)
        end(m, slot, before);
      else
        turn(m, slot, before, t);
    }
    return t >= 0;
  }

  template <class I>
  CDEM_HD void operator()(const I& item) const {
    using T = Number<I>;
    const T dt(faces.dt), zero(0.0);
    const auto& slot = item.id;
    const auto t = look_up(springs.target, slot), before = look_up(springs.target_before, slot);
    const auto moves = differ(t, before);  // it begins, or changes its face
    const auto begins = numbers_of([](Index b) { return b < 0; }, before) > zero;
    const Four<T> forces = InRows{springs.state}.at(slot, 0);
    const ContactBefore<T> old{select(begins, zero, forces.x), select(begins, zero, forces.y),
                               select(begins, zero, forces.z), select(begins, zero, forces.w)};
    const Four<T> rest = InRows{springs.state}.at(slot, 4);  // see turn
    const T free_before = select(begins, zero, rest.x);

    const auto corners = geometry.vertices(t);
    const FaceShape<T> shape = faces.shape(corners);
    const Frame<T> frame = shape.frame(geometry.normal(t));
    const Point<T> mother = mother_point(item.row, slot);
    const Projection<T> foot = project(shape, mother.x, frame.n);

    // where the target was one step ago
    FaceShape<T> old_shape = shape;
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
    const auto law = laws.between(geometry, item.row, t);
    const auto property = [&](auto of) {
      return numbers_of([&](Index l) { return of(laws.interfaces[l]); }, law);
    };
    // half of it: the other block's semi-springs see the contact too
    const auto stiffness = laws.stiffness(geometry, law, item.row, t);
    const T kn = T(0.5) * stiffness.n, ks = T(0.5) * stiffness.s;
    const T tan_friction = property([](const Interface& l) { return l.tan_friction; });
    const T dashpot = T(2.0 * laws.damping_ratio) * sqrt_of(kn / inverse_mass);
    const T gap_rate = dot(frame.n, rate);
    const T free = select(moves,
                          starting_stress_free_gap(foot.gap, gap_rate, dt, old.penetration,
                                                   max_of(free_before, zero)),
                          lifted_stress_free_gap(free_before, foot.gap));
    const Dilation<T> dilation{
        min_of(property([](const Interface& l) { return l.tan_dilation; }), tan_friction),
        max_of(property([](const Interface& l) { return l.dilation_most; }) - free, zero)};
    const T slip1 = -dot(old_frame.t1, apart), slip2 = -dot(old_frame.t2, apart);
    const ContactForce<T> f = contact_force(kn, ks, tan_friction, foot.gap - free, gap_rate,
                                            dashpot, slip1, slip2, old, dilation, dt);
    const T state[8] = {f.force_n,     f.penetration, f.shear1,   f.shear2,
                        free + f.lift, f.energy_n,    f.energy_s, zero};
    set_rows(springs.state, slot, state);
    // A turn loses what the springs held on the old face and neither gave back nor hold on the new
    // one. If it should make energy, that is no loss: it is left to the closing error.
    const auto turns = moves & !begins;
    const T half(0.5);
    const T lost_s = rest.z - f.energy_s - half * (f.shear1 * slip1 + f.shear2 * slip2);
    const T lost_n = rest.y - f.energy_n - half * f.force_n * gap_rate * dt;
    add_to(springs.friction, slot, select(turns, lost_s, f.friction));
    add_to(springs.dashpot, slot, select(turns, max_of(lost_n, -lost_s), f.dashpot));

    const Vec3<T> force = f.force_n * frame.n + f.shear1 * frame.t1 + f.shear2 * frame.t2;
    // the target takes the force where its line of action meets the face: no couple is left over
    const auto pressed = f.force_n > zero;
    const T lever = select(pressed, foot.gap / f.force_n, zero);
    const Projection<T> meet = project(shape, mother.x - lever * force, frame.n);
    const T reaction[8] = {force.x,
                           force.y,
                           force.z,
                           select(pressed, max_of(kn, ks), zero),
                           select(pressed, meet.weight[0], foot.weight[0]),
                           select(pressed, meet.weight[1], foot.weight[1]),
                           select(pressed, meet.weight[2], foot.weight[2]),
                           select(pressed, meet.weight[3], foot.weight[3])};
    set_rows(springs.reaction, slot, reaction);
  }

 private:
  template <class T>
  struct Point {
    Vec3<T> x, x_old, v;
    T inverse_mass;  // under a force: sum w^2 / m  [1/kg]
  };
  /// The acting point: the vertex, moved towards the face's centre by the action coefficient.
  template <class Ids>
  CDEM_HD auto mother_point(const Ids& m, const Ids& slot) const {
    using T = Number<Ids>;
    const T dt(faces.dt), zero(0.0);
    Point<T> p{{zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}, zero};
    const auto add = [&](const Ids& node, const T& w) {
      const Vec3<T> x = faces.nodes.position(node), v = faces.nodes.velocity(node);
      p.x = p.x + w * x;
      p.x_old = p.x_old + w * (x - dt * v);
      p.v = p.v + w * v;
      p.inverse_mass += w * w / look_up(laws.node_mass, node);
    };
    if (!(rules.action > 0)) {
      const auto corner = [&](Index x, Index s) { return geometry.table[x].corner[s % 4]; };
      add(indices_of(corner, m, slot), T(1.0));
      return p;
    }
    const FaceVertices<Ids> corners = geometry.vertices(m);
    for (Index j = 0; j < 4; ++j)
      add(corners.node[j],
          numbers_of([&](Index x, Index s) { return share(x, s % 4, j); }, m, slot));
    return p;
  }
  /// What the acting point of vertex k takes of vertex j.
  CDEM_HD Real share(Index m, Index k, Index j) const {
    const Index count = geometry.table[m].count();
    if (j >= count) return 0.0;
    return rules.action / Real(count) + (j == k ? 1.0 - rules.action : 0.0);
  }
  /// A contact that changes its face keeps the shear force, turned into the new plane with its
  /// length kept (hand-over), and sinks in as far as gives the normal spring there the energy it
  /// had: as deep as before would make some where the new face is the stiffer one. Until it has its
  /// new force, its energies are what its springs held on the old face and did not give back.
  CDEM_HD void turn(Index m, Index slot, Index before, Index t) const {
    ContactState s = ContactState::at(springs.state, slot);
    const DissipatedAtEnd left = lost_on(m, slot, before);
    const Frame<Real> from = faces.shape(geometry.vertices(before)).frame();
    const Frame<Real> to = faces.shape(geometry.vertices(t)).frame();
    const Real s1 = s.shear1, s2 = s.shear2;
    const Vec3<Real> shear = s1 * from.t1 + s2 * from.t2;
    const Real a = dot(shear, to.t1), b = dot(shear, to.t2);
    const Real in_plane = sqrt_of(a * a + b * b);
    const Real scale = in_plane > 0 ? sqrt_of(s1 * s1 + s2 * s2) / in_plane : 0.0;
    s.shear1 = scale * a;
    s.shear2 = scale * b;
    const Real kn = 0.5 * laws.stiffness(geometry, laws.between(geometry, m, t), m, t).n;
    s.penetration = sqrt_of(2 / kn * s.energy_n);
    s.energy_n = left.dashpot;
    s.energy_s = left.friction;
    s.store(springs.state, slot);
  }
  /// A contact that ended forgets its forces.
  CDEM_HD void end(Index m, Index slot, Index before) const {
    const DissipatedAtEnd lost = lost_on(m, slot, before);
    springs.friction[slot] += lost.friction;
    springs.dashpot[slot] += lost.dashpot;
    ContactState{}.store(springs.state, slot);
    Real* row = springs.reaction + std::size_t(slot) * 8;
    row[0] = row[1] = row[2] = row[3] = 0;
  }
  /// What the springs held on a face that they have left, and did not give back.
  CDEM_HD DissipatedAtEnd lost_on(Index m, Index slot, Index before) const {
    const FaceVertices<Index> corners = geometry.vertices(before);
    FaceShape<Real> shape = faces.shape(corners);
    Vec3<Real> moved[4];
    for (Index j = 0; j < 4; ++j) {
      moved[j] = faces.dt * faces.nodes.velocity(corners.node[j]);
      shape.x[j] = shape.x[j] - moved[j];
    }
    const Frame<Real> frame = shape.frame();
    const Point<Real> mother = mother_point(m, slot);
    const Projection<Real> foot = project(shape, mother.x_old, frame.n);
    Vec3<Real> way = mother.x - mother.x_old;
    for (Index j = 0; j < 4; ++j) way = way - foot.weight[j] * moved[j];
    return {ContactState::at(springs.state, slot), frame, way};
  }
};

}  // namespace cdem
