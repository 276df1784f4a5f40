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
CDEM_HD inline Real starting_gap_free(Real gap, Real gap_rate, Real dt, Real sunk_before,
                                      Real dilated) {
  const Real gap_before = gap - gap_rate * dt;
  return min_of(gap_before + sunk_before, dilated);
}

/// Once a contact is lifted past its stress-free gap, that gap follows it back towards zero; one
/// that has dilated stays on top of its asperities.
CDEM_HD inline Real lifted_gap_free(Real gap_free, Real gap) {
  return gap_free > 0 ? gap_free : min_of(max_of(gap_free, gap), 0.0);
}

/// Elastic and frictional part of one contact's force.
struct ContactForce {
  Real force_n;             // compression > 0  [N]
  Real sunk;                // effective penetration  [m]
  Real shear1, shear2;      // on the mother  [N]
  Real energy_n, energy_s;  // stored  [J]
  Real friction;            // lost in this step  [J]
  Real dashpot;             // lost in this step  [J]
  Real rise;                // of the stress-free gap, by dilation in this step  [m]
};

/// What a sliding contact needs to know of its asperities.
struct Dilation {
  Real tangent;  // tan(psi)
  Real room;     // opening that is left before it dilates no more  [m]
};

/// What a contact had one step ago; all zero for one that begins.
struct ContactBefore {
  Real force_n, sunk;   // [N], [m]
  Real shear1, shear2;  // [N]
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
CDEM_HD inline ContactForce contact_force(Real stiffness_n, Real stiffness_s, Real tan_friction,
                                          Real gap, Real gap_rate, Real dashpot_constant,
                                          Real slip1, Real slip2, const ContactBefore& before,
                                          const Dilation& dilation, Real dt) {
  ContactForce f;
  Real elastic = max_of(-stiffness_n * gap, 0.0);
  f.force_n = max_of(elastic - dashpot_constant * gap_rate, 0.0);
  if (gap >= 0) f.force_n = 0;
  f.sunk = max_of(-gap, 0.0);
  const Real old1 = before.shear1, old2 = before.shear2;
  const Real try1 = old1 - stiffness_s * slip1, try2 = old2 - stiffness_s * slip2;
  const Real shear = sqrt_of(try1 * try1 + try2 * try2);
  Real limit = f.force_n * tan_friction;
  f.rise = 0;
  if (dilation.tangent > 0 && f.force_n > 0 && shear > limit) {
    const Real stiffer = stiffness_s + stiffness_n * dilation.tangent * tan_friction;
    f.rise = min_of(dilation.tangent * (shear - limit) / stiffer, dilation.room);
    f.sunk += f.rise;
    f.force_n += stiffness_n * f.rise;
    elastic += stiffness_n * f.rise;
    limit = f.force_n * tan_friction;
  }
  const Real keep = shear > limit ? limit / shear : 1.0;
  f.shear1 = keep * try1;
  f.shear2 = keep * try2;
  const Real flex_s = 0.5 / stiffness_s;
  const Real stored_s = flex_s * (f.shear1 * f.shear1 + f.shear2 * f.shear2);
  f.friction = flex_s * (old1 * old1 + old2 * old2) - stored_s -
               0.5 * ((old1 + f.shear1) * slip1 + (old2 + f.shear2) * slip2) -
               0.5 * (stiffness_n * before.sunk + elastic) * f.rise;
  f.energy_n = 0.5 / stiffness_n * elastic * elastic;
  f.energy_s = stored_s;
  const Real braked = before.force_n - stiffness_n * before.sunk + f.force_n - elastic;
  f.dashpot = -0.5 * braked * gap_rate * dt;
  return f;
}

/// What a contact remembers of its force.
CDEM_HD inline void keep(ContactState& s, const ContactForce& f) {
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
    const Frame frame = shape.frame(geometry.normal(t));
    const Mother mother = mother_point(face_m, k);
    const Projection foot = project(shape, mother.x, frame.n);

    const FaceShape old_shape = faces.old_shape(face_t);
    const Frame old = old_shape.frame();
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
    const Dilation dilation{min_of(law.tan_dilation, law.tan_friction),
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
    const Frame from = faces.shape(exposed_face[before]).frame();
    const Frame to = faces.shape(face_t).frame();
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

  CDEM_HD void operator()(One place) const {
    const EdgeContact contact = EdgeContact::at(edges.contact, place.i);
    const Index m = contact.mother / 4, t = contact.face;
    const Index face_m = exposed_face[m], face_t = exposed_face[t];
    const Side sm = side_of(face_m, contact.mother % 4);
    // the frame belongs to the edge, whichever of its faces is the right one just now
    const Side st{faces.edge_nodes[2 * contact.edge], faces.edge_nodes[2 * contact.edge + 1]};
    ContactState s = contact.before >= 0 ? ContactState::at(state_before, contact.before)
                                         : ContactState{0, -1, 0, 0, 0, 0, 0};
    const Vec3<Real> xm = faces.nodes.position(sm.a), xt = faces.nodes.position(st.a);
    const Vec3<Real> dm = faces.nodes.position(sm.b) - xm, dt = faces.nodes.position(st.b) - xt;
    const Vec3<Real> out = geometry.normal(t) - geometry.normal(m);
    const Frame frame = edge_frame(edge_normal(dm, dt, out), dt);
    const Crossing c = cross_edges(xm, dm, xt, dt, frame.n);

    const Vec3<Real> om = faces.old_position(sm.a), ot = faces.old_position(st.a);
    const Vec3<Real> old_dm = faces.old_position(sm.b) - om, old_dt = faces.old_position(st.b) - ot;
    const Frame old = edge_frame(edge_normal(old_dm, old_dt, out), old_dt);
    const Vec3<Real> apart = (om + c.s * old_dm) - (ot + c.t * old_dt);

    const Vec3<Real> vm = faces.nodes.velocity(sm.a), vt = faces.nodes.velocity(st.a);
    const Vec3<Real> rate = (vm + c.s * (faces.nodes.velocity(sm.b) - vm)) -
                            (vt + c.t * (faces.nodes.velocity(st.b) - vt));
    const Real flex = flexibility(sm, c.s) + flexibility(st, c.t);

    const Interface& law = laws.between(faces.face_group[face_m], faces.face_group[face_t]);
    const Real stiffer = max_of(faces.face_stiffness[face_m], faces.face_stiffness[face_t]);
    // A_SE of Eq. 5, and a half of it because the other block's semi-edges see the crossing too
    const Real area = faces.contact_area(face_m, face_t);
    const Real kn = area * law.stiffness_n(stiffer), ks = area * law.stiffness_s(stiffer);
    const Real dashpot = 2.0 * laws.damping_ratio * sqrt_of(kn / flex);
    const Real gap_rate = dot(frame.n, rate);
    s.gap_free = s.sunk >= 0 ? lifted_gap_free(s.gap_free, c.gap)
                             : starting_gap_free(c.gap, gap_rate, faces.dt, 0.0, 0.0);
    const ContactForce f =
        contact_force(kn, ks, law.tan_friction, c.gap - s.gap_free, gap_rate, dashpot,
                      -dot(old.t1, apart), -dot(old.t2, apart),
                      {s.force_n, max_of(s.sunk, 0.0), s.shear1, s.shear2}, {0.0, 0.0}, faces.dt);
    keep(s, f);
    s.store(edges.state, place.i);

    const Vec3<Real> force = f.force_n * frame.n + f.shear1 * frame.t1 + f.shear2 * frame.t2;
    // both edges take the force on one line of action: no couple is left over
    const Crossing line = f.force_n > 0 ? cross_edges(xm, dm, xt, dt, force) : c;
    Real* row = edges.reaction + std::size_t(place.i) * 8;
    row[0] = force.x, row[1] = force.y, row[2] = force.z;
    row[3] = f.force_n > 0 ? max_of(kn, ks) : 0.0;
    row[4] = line.s;
    row[5] = faces.vertex(face_t, side_on(face_t, contact.edge)) == st.a ? line.t : 1.0 - line.t;
    row[6] = f.friction, row[7] = f.dashpot;
  }

 private:
  struct Side {
    Index a, b;  // nodes at its ends
  };
  CDEM_HD Side side_of(Index face, Index k) const {
    return {faces.vertex(face, k),
            faces.vertex(face, k + 1 == faces.vertex_count(face) ? 0 : k + 1)};
  }
  CDEM_HD Real flexibility(const Side& side, Real s) const {
    return (1.0 - s) * (1.0 - s) / laws.node_mass[side.a] + s * s / laws.node_mass[side.b];
  }
  CDEM_HD Index side_on(Index face, Index edge) const {
    for (Index k = 0; k < 3; ++k)
      if (faces.face_edges[4 * face + k] == edge) return k;
    return 3;
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
      const Index k = side_on(face, contact.edge);
      take(sum[k], 1.0 - row[5], row);
      take(sum[k + 1 == count ? 0 : k + 1], row[5], row);
    }
  }
  CDEM_HD Index side_on(Index face, Index edge) const {
    for (Index k = 0; k < 3; ++k)
      if (faces.face_edges[4 * face + k] == edge) return k;
    return 3;
  }
};

}  // namespace cdem
