// force.hpp - forces of semi-springs and semi-edges in contact. Feng et al. (2014), Eq. 13-14.
#pragma once

#include "core/contact/target_edge.hpp"
#include "core/interfaces/brittle_coulomb.hpp"

namespace cdem {

/// Interfaces by pair of groups, and the contact dashpot.
struct ContactLaws {
  const Index* interface_of;  // [group_m * group_count + group_t]
  const Interface* interfaces;
  Index group_count;
  Real damping_ratio;     // of critical, on the effective mass of the two points
  const Real* node_mass;  // [kg]

  /// The interface between two exposed faces, or between one and another a lane.
  template <class Ids>
  CDEM_HD auto between(const FaceGeometry& geometry, const Ids& m, const Ids& t) const {
    return indices_of(
        [&](Index a, Index b) {
          return interface_of[geometry.table[a].group * group_count + geometry.table[b].group];
        },
        m, t);
  }
  template <class T>
  struct Stiffness {
    T n, s;  // [N/m]
  };
  /// Stiffness of a contact of theirs on its characteristic area.
  template <class Ids>
  CDEM_HD auto stiffness(const FaceGeometry& geometry, const Ids& law, const Ids& m,
                         const Ids& t) const {
    const auto on_area = [&](auto per_area) {
      return numbers_of(
          [&](Index l, Index a, Index b) {
            return geometry.contact_area(a, b) * per_area(interfaces[l], geometry.stiffer(a, b));
          },
          law, m, t);
    };
    return Stiffness<Number<Ids>>{
        on_area([](const Interface& l, Real stiffer) { return l.stiffness_n(stiffer); }),
        on_area([](const Interface& l, Real stiffer) { return l.stiffness_s(stiffer); })};
  }
};

/// The gap at which a contact that begins is free of stress.
///
/// A contact met from outside is free at zero gap. One that is found already inside must not
/// release energy that nothing put in (faces of freshly broken rock have slid a little past each
/// other, a vertex turns a corner): it may begin with the energy of the contact it takes over from,
/// `sunk_before` deep; what is deeper counts as free of stress.
/// `dilated` is how far that contact had opened by dilation.
template <class T>
CDEM_HD inline T starting_gap_free(T gap, T gap_rate, T dt, T sunk_before, T dilated) {
  const T gap_before = gap - gap_rate * dt;
  return min_of(gap_before + sunk_before, dilated);
}

/// Once a contact is lifted past its stress-free gap, that gap follows it back towards zero; one
/// that has dilated stays on top of its asperities.
template <class T>
CDEM_HD inline T lifted_gap_free(T gap_free, T gap) {
  const T zero(0.0);
  return select(gap_free > zero, gap_free, min_of(max_of(gap_free, gap), zero));
}

/// Elastic and frictional part of one contact's force.
template <class T>
struct ContactForce {
  T force_n;             // compression > 0  [N]
  T sunk;                // effective penetration  [m]
  T shear1, shear2;      // on the mother  [N]
  T energy_n, energy_s;  // stored  [J]
  T friction;            // lost in this step  [J]
  T dashpot;             // lost in this step  [J]
  T rise;                // of the stress-free gap, by dilation in this step  [m]
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
  T force_n, sunk;   // [N], [m]
  T shear1, shear2;  // [N]
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
  f.sunk = max_of(-gap, zero);
  const T old1 = before.shear1, old2 = before.shear2;
  const T try1 = old1 - stiffness_s * slip1, try2 = old2 - stiffness_s * slip2;
  const T shear = sqrt_of(try1 * try1 + try2 * try2);
  T limit = f.force_n * tan_friction;
  f.rise = zero;
  const auto dilates = (dilation.tangent > zero) & (f.force_n > zero) & (shear > limit);
  if (any_of(dilates)) {
    const T stiffer = stiffness_s + stiffness_n * dilation.tangent * tan_friction;
    const T rise = min_of(dilation.tangent * (shear - limit) / stiffer, dilation.room);
    f.rise = select(dilates, rise, zero);
    f.sunk += f.rise;
    f.force_n += stiffness_n * f.rise;
    elastic += stiffness_n * f.rise;
    limit = f.force_n * tan_friction;
  }
  const T keep = select(shear > limit, limit / shear, one);
  f.shear1 = keep * try1;
  f.shear2 = keep * try2;
  const T flex_s = half / stiffness_s;
  const T stored_s = flex_s * (f.shear1 * f.shear1 + f.shear2 * f.shear2);
  f.friction = flex_s * (old1 * old1 + old2 * old2) - stored_s -
               half * ((old1 + f.shear1) * slip1 + (old2 + f.shear2) * slip2) -
               half * (stiffness_n * before.sunk + elastic) * f.rise;
  f.energy_n = half / stiffness_n * elastic * elastic;
  f.energy_s = stored_s;
  const T braked = before.force_n - stiffness_n * before.sunk + f.force_n - elastic;
  f.dashpot = -half * braked * gap_rate * dt;
  return f;
}

/// Force of every semi-spring in contact; slot = 4 * exposed face + vertex.
struct UpdateSpringForces {
  FaceColumns faces;
  FaceGeometry geometry;
  SearchRules rules;
  ContactLaws laws;
  SpringColumns springs;

  CDEM_HD Range items(Index m) const { return {4 * m, 4 * m + 4}; }
  /// Slots that are in contact; those that no longer are end here.
  CDEM_HD bool picks(Index m, Index slot) const {
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
    T flex = mother.flex;
    for (Index j = 0; j < 4; ++j) {
      apart = apart - foot.weight[j] * old_shape.x[j];
      rate = rate - foot.weight[j] * velocity[j];
      flex += foot.weight[j] * foot.weight[j] / look_up(laws.node_mass, corners.node[j]);
    }
    const auto law = laws.between(geometry, item.row, t);
    const auto property = [&](auto of) {
      return numbers_of([&](Index l) { return of(laws.interfaces[l]); }, law);
    };
    // half of it: the other block's semi-springs see the contact too
    const auto stiffness = laws.stiffness(geometry, law, item.row, t);
    const T kn = T(0.5) * stiffness.n, ks = T(0.5) * stiffness.s;
    const T tan_friction = property([](const Interface& l) { return l.tan_friction; });
    const T dashpot = T(2.0 * laws.damping_ratio) * sqrt_of(kn / flex);
    const T gap_rate = dot(frame.n, rate);
    const T free = select(
        moves, starting_gap_free(foot.gap, gap_rate, dt, old.sunk, max_of(free_before, zero)),
        lifted_gap_free(free_before, foot.gap));
    const Dilation<T> dilation{
        min_of(property([](const Interface& l) { return l.tan_dilation; }), tan_friction),
        max_of(property([](const Interface& l) { return l.dilation_most; }) - free, zero)};
    const T slip1 = -dot(old_frame.t1, apart), slip2 = -dot(old_frame.t2, apart);
    const ContactForce<T> f = contact_force(kn, ks, tan_friction, foot.gap - free, gap_rate,
                                            dashpot, slip1, slip2, old, dilation, dt);
    const T state[8] = {f.force_n,     f.sunk,     f.shear1,   f.shear2,
                        free + f.rise, f.energy_n, f.energy_s, zero};
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
    T flex;  // under a force: sum w^2 / m  [1/kg]
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
      p.flex += w * w / look_up(laws.node_mass, node);
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
    const LostAtEnd left = lost_on(m, slot, before);
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
    s.sunk = sqrt_of(2 / kn * s.energy_n);
    s.energy_n = left.dashpot;
    s.energy_s = left.friction;
    s.store(springs.state, slot);
  }
  /// A contact that ended forgets its forces.
  CDEM_HD void end(Index m, Index slot, Index before) const {
    const LostAtEnd lost = lost_on(m, slot, before);
    springs.friction[slot] += lost.friction;
    springs.dashpot[slot] += lost.dashpot;
    ContactState{}.store(springs.state, slot);
    Real* row = springs.reaction + std::size_t(slot) * 8;
    row[0] = row[1] = row[2] = row[3] = 0;
  }
  /// What the springs held on a face that they have left, and did not give back.
  CDEM_HD LostAtEnd lost_on(Index m, Index slot, Index before) const {
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
    const T sunk = was([](const ContactState& s) { return s.sunk; });
    const T gap_free = was([](const ContactState& s) { return s.gap_free; });
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
    const T flex = flexibility(m0, m1, c.s) + flexibility(t0, t1, c.t);
    const T dashpot = T(2.0 * laws.damping_ratio) * sqrt_of(kn / flex);
    const T gap_rate = dot(frame.n, rate);
    const T free = select(sunk < zero, starting_gap_free(c.gap, gap_rate, dt, zero, zero),
                          lifted_gap_free(gap_free, c.gap));
    const ContactBefore<T> old_force{was([](const ContactState& s) { return s.force_n; }),
                                     max_of(sunk, zero),
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
    const T state[8] = {f.force_n, f.sunk, f.shear1, f.shear2, free, f.energy_n, f.energy_s, zero};
    const T reaction[8] = {force.x,    force.y,
                           force.z,    select(pressed, max_of(kn, ks), zero),
                           on_m,       select(forward > zero, on_t, one - on_t),
                           f.friction, f.dashpot};
    set_rows(edges.state, item, state);
    set_rows(edges.reaction, item, reaction);
  }

 private:
  template <class Ids, class T>
  CDEM_HD T flexibility(const Ids& a, const Ids& b, const T& s) const {
    const T rest = T(1.0) - s;
    return rest * rest / look_up(laws.node_mass, a) + s * s / look_up(laws.node_mass, b);
  }
};

}  // namespace cdem
