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

  CDEM_HD const Interface& between(Index group_m, Index group_t) const {
    return interfaces[interface_of[group_m * group_count + group_t]];
  }
};

/// The gap at which a contact that begins is free of stress.
///
/// A contact met from outside is free at zero gap. One that is found already inside must not
/// release energy that nothing put in (faces of freshly broken rock have slid a little past each
/// other, a vertex turns a corner): it may begin as deep as the contact it takes over from; what is
/// deeper counts as free of stress.
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

/// What a contact remembers of its force.
CDEM_HD inline void keep(ContactState& s, const ContactForce<Real>& f) {
  s.force_n = f.force_n, s.sunk = f.sunk;
  s.shear1 = f.shear1, s.shear2 = f.shear2;
  s.energy_n = f.energy_n, s.energy_s = f.energy_s;
}

/// Force of every semi-spring in contact; slot = 4 * exposed face + vertex.
struct UpdateSpringForces {
  FaceColumns faces;
  FaceGeometry geometry;
  const Index* exposed_face;
  SearchRules rules;
  ContactLaws laws;
  SpringColumns springs;

  CDEM_HD void operator()(One slot) const {
    const Index m = slot.i / 4, k = slot.i % 4, t = springs.target[slot.i];
    const Index before = springs.target_before[slot.i];
    if (t < 0) {
      if (before >= 0) end(slot.i);
      return;
    }
    const Index face_m = exposed_face[m], face_t = exposed_face[t];
    ContactState s = before >= 0 ? ContactState::at(springs.state, slot.i) : ContactState{};
    if (before >= 0 && before != t) carry_shear(s, before, face_t);

    const FaceShape shape = faces.shape(face_t);
    const Frame<Real> frame = shape.frame(geometry.normal(t));
    const Mother mother = mother_point(face_m, k);
    const Projection foot = project(shape, mother.x, frame.n);

    const FaceShape old_shape = faces.old_shape(face_t);
    const Frame<Real> old = old_shape.frame();
    Vec3<Real> apart = mother.x_old, rate = mother.v;
    Real flex = mother.flex;
    for (Index j = 0; j < shape.count; ++j) {
      const Index node = faces.vertex(face_t, j);
      apart = apart - foot.weight[j] * old_shape.x[j];
      rate = rate - foot.weight[j] * faces.nodes.velocity(node);
      flex += foot.weight[j] * foot.weight[j] / laws.node_mass[node];
    }
    const Interface& law = laws.between(faces.face_group[face_m], faces.face_group[face_t]);
    const Real stiffer = max_of(faces.face_stiffness[face_m], faces.face_stiffness[face_t]);
    const Real area = 0.5 * faces.contact_area(face_m, face_t);
    const Real kn = area * law.stiffness_n(stiffer), ks = area * law.stiffness_s(stiffer);
    const Real dashpot = 2.0 * laws.damping_ratio * sqrt_of(kn / flex);
    const Real gap_rate = dot(frame.n, rate);
    s.gap_free = before == t ? lifted_gap_free(s.gap_free, foot.gap)
                             : starting_gap_free(foot.gap, gap_rate, faces.dt, s.sunk,
                                                 max_of(s.gap_free, 0.0));
    const Dilation<Real> dilation{min_of(law.tan_dilation, law.tan_friction),
                                  max_of(law.dilation_most - s.gap_free, 0.0)};
    ContactForce f = contact_force(kn, ks, law.tan_friction, foot.gap - s.gap_free, gap_rate,
                                   dashpot, -dot(old.t1, apart), -dot(old.t2, apart),
                                   {s.force_n, s.sunk, s.shear1, s.shear2}, dilation, faces.dt);
    s.gap_free += f.rise;
    if (before >= 0 && before != t) f.dashpot = 0;  // a change of face is no work of the dashpot
    keep(s, f);
    s.store(springs.state, slot.i);
    springs.friction[slot.i] += f.friction;
    springs.dashpot[slot.i] += f.dashpot;

    const Vec3<Real> force = f.force_n * frame.n + f.shear1 * frame.t1 + f.shear2 * frame.t2;
    // the target takes the force where its line of action meets the face: no couple is left over
    const Projection meet =
        f.force_n > 0 ? project(shape, mother.x - (foot.gap / f.force_n) * force, frame.n) : foot;
    Real* row = springs.reaction + std::size_t(slot.i) * 8;
    row[0] = force.x, row[1] = force.y, row[2] = force.z;
    row[3] = f.force_n > 0 ? max_of(kn, ks) : 0.0;
    for (Index j = 0; j < 4; ++j) row[4 + j] = meet.weight[j];
  }

 private:
  struct Mother {
    Vec3<Real> x, x_old, v;
    Real flex;  // of the point under a force: sum w^2 / m  [1/kg]
  };
  /// The acting point: the vertex, moved towards the face's centre by the action coefficient.
  CDEM_HD Mother mother_point(Index face, Index k) const {
    const Index count = faces.vertex_count(face);
    const Real shared = rules.action / Real(count);
    Mother p{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, 0};
    for (Index j = 0; j < count; ++j) {
      const Real w = shared + (j == k ? 1.0 - rules.action : 0.0);
      if (w == 0) continue;
      const Index node = faces.vertex(face, j);
      p.x = p.x + w * faces.nodes.position(node);
      p.x_old = p.x_old + w * faces.old_position(node);
      p.v = p.v + w * faces.nodes.velocity(node);
      p.flex += w * w / laws.node_mass[node];
    }
    return p;
  }
  /// A contact that changes its face keeps the shear force, turned into the new plane with its
  /// length kept (hand-over).
  CDEM_HD void carry_shear(ContactState& s, Index before, Index face_t) const {
    const Frame<Real> from = faces.shape(exposed_face[before]).frame();
    const Frame<Real> to = faces.shape(face_t).frame();
    const Real s1 = s.shear1, s2 = s.shear2;
    const Vec3<Real> shear = s1 * from.t1 + s2 * from.t2;
    const Real a = dot(shear, to.t1), b = dot(shear, to.t2);
    const Real in_plane = sqrt_of(a * a + b * b);
    const Real scale = in_plane > 0 ? sqrt_of(s1 * s1 + s2 * s2) / in_plane : 0.0;
    s.shear1 = scale * a;
    s.shear2 = scale * b;
  }
  /// A contact that opened forgets its shear force; what that spring held is lost to friction, and
  /// what the normal spring held and did not give back to the dashpot.
  CDEM_HD void end(Index slot) const {
    const ContactState s = ContactState::at(springs.state, slot);
    springs.friction[slot] += s.energy_s;
    springs.dashpot[slot] += s.energy_n - 0.5 * s.force_n * s.sunk;
    ContactState{}.store(springs.state, slot);
    Real* row = springs.reaction + std::size_t(slot) * 8;
    row[0] = row[1] = row[2] = row[3] = 0;
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
    Known<I> k;
    for_lanes(item, [&](Index lane, Index place) { look_up(k, lane, place); });

    const InMotion& nodes = faces.nodes;
    const T dt(faces.dt), zero(0.0), one(1.0);
    const Vec3<T> xm = nodes.position(k.m0), xt = nodes.position(k.t0);
    const Vec3<T> xm1 = nodes.position(k.m1), xt1 = nodes.position(k.t1);
    const Vec3<T> dm = xm1 - xm, along_t = xt1 - xt;
    const Frame<T> frame = edge_frame(edge_normal(dm, along_t, k.out), along_t);
    const Crossing<T> c = cross_edges(xm, dm, xt, along_t, frame.n);

    const Vec3<T> vm = nodes.velocity(k.m0), vt = nodes.velocity(k.t0);
    const Vec3<T> vm1 = nodes.velocity(k.m1), vt1 = nodes.velocity(k.t1);
    const Vec3<T> om = xm - dt * vm, ot = xt - dt * vt;  // one step ago
    const Vec3<T> old_dm = (xm1 - dt * vm1) - om, old_along = (xt1 - dt * vt1) - ot;
    const Frame<T> old = edge_frame(edge_normal(old_dm, old_along, k.out), old_along);
    const Vec3<T> apart = (om + c.s * old_dm) - (ot + c.t * old_along);
    const Vec3<T> rate = (vm + c.s * (vm1 - vm)) - (vt + c.t * (vt1 - vt));
    const T flex = flexibility(k.m0, k.m1, c.s) + flexibility(k.t0, k.t1, c.t);

    const T dashpot = T(2.0) * T(laws.damping_ratio) * sqrt_of(k.kn / flex);
    const T gap_rate = dot(frame.n, rate);
    const T free = select(k.sunk < zero, starting_gap_free(c.gap, gap_rate, dt, zero, zero),
                          lifted_gap_free(k.gap_free, c.gap));
    const ContactForce<T> f = contact_force(
        k.kn, k.ks, k.tan_friction, c.gap - free, gap_rate, dashpot, -dot(old.t1, apart),
        -dot(old.t2, apart), ContactBefore<T>{k.force_n, max_of(k.sunk, zero), k.shear1, k.shear2},
        Dilation<T>{zero, zero}, dt);

    const Vec3<T> force = f.force_n * frame.n + f.shear1 * frame.t1 + f.shear2 * frame.t2;
    // both edges take the force on one line of action: no couple is left over
    const Crossing<T> line = cross_edges(xm, dm, xt, along_t, force);
    const auto pressed = f.force_n > zero;
    const T on_m = select(pressed, line.s, c.s), on_t = select(pressed, line.t, c.t);
    const T state[8] = {f.force_n, f.sunk, f.shear1, f.shear2, free, f.energy_n, f.energy_s, zero};
    const T reaction[8] = {force.x,    force.y,
                           force.z,    select(pressed, max_of(k.kn, k.ks), zero),
                           on_m,       select(k.forward > zero, on_t, one - on_t),
                           f.friction, f.dashpot};
    set_rows(edges.state, item, state);
    set_rows(edges.reaction, item, reaction);
  }

 private:
  /// What the tables know of a contact, or of a lane of them.
  template <class I>
  struct Known {
    using T = Number<I>;
    typename IndexOf<I>::type m0, m1, t0, t1;  // ends of mother side and target edge
    Vec3<T> out;  // from the mother face to the target's: difference of the normals
    T kn, ks, tan_friction;
    T force_n, sunk, shear1, shear2, gap_free;  // one step ago
    T forward;  // 1 where the target face's side goes the way of the edge, else 0
  };
  template <class I>
  CDEM_HD void look_up(Known<I>& k, Index lane, Index place) const {
    const EdgeContact contact = EdgeContact::at(edges.contact, place);
    const Index m = contact.mother / 4, side = contact.mother % 4;
    const Index face_m = exposed_face[m], face_t = exposed_face[contact.face];
    const Index next = side + 1 == faces.vertex_count(face_m) ? 0 : side + 1;
    lane_of(k.m0, lane) = faces.vertex(face_m, side);
    lane_of(k.m1, lane) = faces.vertex(face_m, next);
    // the frame belongs to the edge, whichever of its faces is the right one just now
    const Index t0 = lane_of(k.t0, lane) = faces.edge_nodes[2 * contact.edge];
    lane_of(k.t1, lane) = faces.edge_nodes[2 * contact.edge + 1];
    lane_of(k.forward, lane) = faces.vertex(face_t, faces.side_on(face_t, contact.edge)) == t0;
    const Vec3<Real> out = geometry.normal(contact.face) - geometry.normal(m);
    lane_of(k.out.x, lane) = out.x;
    lane_of(k.out.y, lane) = out.y;
    lane_of(k.out.z, lane) = out.z;

    const Interface& law = laws.between(faces.face_group[face_m], faces.face_group[face_t]);
    const Real stiffer = max_of(faces.face_stiffness[face_m], faces.face_stiffness[face_t]);
    // A_SE of Eq. 5, and a half of it because the other block's semi-edges see the crossing too
    const Real area = faces.contact_area(face_m, face_t);
    lane_of(k.kn, lane) = area * law.stiffness_n(stiffer);
    lane_of(k.ks, lane) = area * law.stiffness_s(stiffer);
    lane_of(k.tan_friction, lane) = law.tan_friction;

    const ContactState s = contact.before >= 0 ? ContactState::at(state_before, contact.before)
                                               : ContactState{0, -1, 0, 0, 0, 0, 0};
    lane_of(k.force_n, lane) = s.force_n;
    lane_of(k.sunk, lane) = s.sunk;
    lane_of(k.shear1, lane) = s.shear1;
    lane_of(k.shear2, lane) = s.shear2;
    lane_of(k.gap_free, lane) = s.gap_free;
  }
  template <class Ids, class T>
  CDEM_HD T flexibility(const Ids& a, const Ids& b, const T& s) const {
    const InLookup mass{laws.node_mass};
    const T rest = T(1.0) - s;
    return rest * rest / mass.at(a) + s * s / mass.at(b);
  }
};

/// Does an exposed face list nothing, and is on no list? Then it has no contacts.
CDEM_HD inline bool is_idle(const Candidates& candidates, const EdgeCandidates& edge_candidates,
                            const Sources& sources, Index m) {
  return candidates.first[4 * m] == candidates.first[4 * m + 4] &&
         edge_candidates.first[m] == edge_candidates.first[m + 1] &&
         sources.first[m] == sources.first[m + 1];
}

/// Mark, among the sources of every exposed face, those whose contacts act on it in this step: most
/// do not. Each face marks where its own contacts act.
struct MarkActing {
  Sources sources;
  SpringColumns springs;
  EdgeColumns edges;
  Flag* acting;  // [source]

  CDEM_HD void operator()(One m) const {
    for (Index k = 0; k < 4; ++k) mark(springs.target[4 * m.i + k], m.i);
    for (Index c = edges.first[m.i]; c < edges.first[m.i + 1]; ++c)
      mark(EdgeContact::at(edges.contact, c).face, m.i);
  }

 private:
  CDEM_HD void mark(Index target, Index source) const {
    if (target < 0) return;
    Index first = sources.first[target], last = sources.first[target + 1];
    while (first < last) {  // the row is in ascending order
      const Index middle = first + (last - first) / 2;
      if (sources.other[middle] < source)
        first = middle + 1;
      else
        last = middle;
    }
    if (first < sources.first[target + 1] && sources.other[first] == source) acting[first] = 1;
  }
};

/// Sum, for one exposed face, the forces of its own semi-springs and semi-edges and the reactions
/// of all others that have it as target. It looks through its sources in their order instead of
/// letting contacts add to nodes, so the sum has one order for any number of threads. An idle face
/// keeps what it has: no node sums it. The marks of its sources are taken back for the next step.
struct GatherFaceForces {
  FaceColumns faces;
  const Index* exposed_face;
  Candidates candidates;
  EdgeCandidates edge_candidates;
  Sources sources;
  SearchRules rules;
  SpringColumns springs;
  EdgeColumns edges;
  Real* edge_friction;  // [exposed] lost so far in its semi-edges  [J]
  Real* edge_dashpot;   // [exposed] lost so far in their dashpots  [J]
  Flag* acting;         // [source] see MarkActing
  Real* corner_force;   // row of 4 per vertex: force x y z [N], stiffness of its contacts [N/m]

  CDEM_HD void operator()(One m) const {
    if (is_idle(candidates, edge_candidates, sources, m.i)) return;
    const Index face = exposed_face[m.i], count = faces.vertex_count(face);
    Real sum[4][4] = {};
    own(m.i, count, sum);
    for (Index c = sources.first[m.i]; c < sources.first[m.i + 1]; ++c) {
      if (!acting[c]) continue;
      reactions(m.i, face, count, sources.other[c], sum);
      acting[c] = 0;
    }
    for (Index k = 0; k < count; ++k)
      for (Index j = 0; j < 4; ++j) corner_force[(std::size_t(m.i) * 4 + k) * 4 + j] = sum[k][j];
  }

 private:
  CDEM_HD static void add(Real* corner, Real weight, const Real* row) {
    corner[0] += weight * row[0];
    corner[1] += weight * row[1];
    corner[2] += weight * row[2];
    corner[3] += abs_of(weight) * row[3];
  }
  CDEM_HD static void take(Real* corner, Real weight, const Real* row) {
    corner[0] -= weight * row[0];
    corner[1] -= weight * row[1];
    corner[2] -= weight * row[2];
    corner[3] += abs_of(weight) * row[3];
  }
  CDEM_HD void own(Index m, Index count, Real sum[4][4]) const {
    const Real shared = rules.action / Real(count);
    for (Index k = 0; k < count; ++k) {
      if (springs.target[4 * m + k] < 0) continue;
      const Real* row = springs.reaction + (std::size_t(m) * 4 + k) * 8;
      add(sum[k], 1.0 - rules.action, row);
      if (shared > 0)
        for (Index j = 0; j < count; ++j) add(sum[j], shared, row);
    }
    for (Index c = edges.first[m]; c < edges.first[m + 1]; ++c) {
      const Real* row = edges.reaction + std::size_t(c) * 8;
      const Index k = EdgeContact::at(edges.contact, c).mother % 4;
      add(sum[k], 1.0 - row[4], row);
      add(sum[k + 1 == count ? 0 : k + 1], row[4], row);
      edge_friction[m] += row[6];
      edge_dashpot[m] += row[7];
    }
  }
  CDEM_HD void reactions(Index m, Index face, Index count, Index other, Real sum[4][4]) const {
    for (Index k = 0; k < 4; ++k) {
      if (springs.target[4 * other + k] != m) continue;
      const Real* row = springs.reaction + (std::size_t(other) * 4 + k) * 8;
      for (Index j = 0; j < count; ++j) take(sum[j], row[4 + j], row);
    }
    for (Index c = edges.first[other]; c < edges.first[other + 1]; ++c) {
      const EdgeContact contact = EdgeContact::at(edges.contact, c);
      if (contact.face != m) continue;
      const Real* row = edges.reaction + std::size_t(c) * 8;
      const Index k = faces.side_on(face, contact.edge);
      take(sum[k], 1.0 - row[5], row);
      take(sum[k + 1 == count ? 0 : k + 1], row[5], row);
    }
  }
};

}  // namespace cdem
