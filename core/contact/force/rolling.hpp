// rolling.hpp - resistance of semi-springs to rolling.
#pragma once

#include "core/base/parallel.hpp"
#include "core/contact/force/accumulate.hpp"
#include "core/contact/force/contact_laws.hpp"
#include "core/contact/force/face_rotation.hpp"

namespace cdem {

/// Couple of a rotation spring, in the frame of the target, and where its energy goes.
struct RollingCouple {
  Real couple1, couple2, energy, friction;

  /// It holds `old`, turns by (turn1, turn2) in the step and slips at `limit`. The loss is the work
  /// of the mean couple less the stored energy.
  CDEM_HD static RollingCouple of(const RollingState& old, Real stiffness, Real turn1, Real turn2,
                                  Real limit) {
    const Real try1 = old.couple1 - stiffness * turn1, try2 = old.couple2 - stiffness * turn2;
    const Real size = sqrt_of(try1 * try1 + try2 * try2);
    const Real keep = size > limit ? limit / size : 1.0;
    RollingCouple c{keep * try1, keep * try2, 0, 0};
    c.energy = 0.5 * (c.couple1 * c.couple1 + c.couple2 * c.couple2) / stiffness;
    c.friction = old.energy - c.energy -
                 0.5 * ((old.couple1 + c.couple1) * turn1 + (old.couple2 + c.couple2) * turn2);
    return c;
  }
};

/// Couples of the semi-springs of one exposed face: elastic against the relative rotation of the
/// two faces about axes in the target's plane, up to mu_r R F_n. R is the radius of a sphere of the
/// volume of the block, the smaller one of two that can move.
struct UpdateRollingCouples {
  FaceColumns faces;
  FaceGeometry geometry;
  ContactLaws laws;
  SpringColumns springs;
  const Index* exposed_face;
  const Real* face_radius;  // [face]
  Real* rows;               // of RollingState

  CDEM_HD void operator()(One m) const {
    for (Index slot = 4 * m.i; slot < 4 * m.i + 4; ++slot) {
      const Index t = springs.target[slot], before = springs.target_before[slot];
      if (t >= 0)
        update(m.i, slot, before, t);
      else if (before >= 0)
        end(m.i, slot, before);
    }
  }

 private:
  CDEM_HD void update(Index m, Index slot, Index before, Index t) const {
    RollingState s = RollingState::at(rows, slot);
    const Index interface = laws.between(geometry, m, t);
    const Real resistance = laws.faces.interfaces[interface].rolling_resistance;
    if (!(resistance > 0) && !(s.energy > 0)) return;
    const FaceShape<Real> mother = faces.shape(geometry.vertices(m)),
                          target = faces.shape(geometry.vertices(t));
    const Real lever_squared =
        min_of(FaceRotation::of(mother).lever_squared(), FaceRotation::of(target).lever_squared());
    const Real stiffness = 0.5 * laws.spring(geometry, interface, m, t).n() * lever_squared;
    const Frame<Real> frame = target.frame();
    if (before != t) turn_to(frame, stiffness, s);
    const Vec3<Real> turn = relative_turn(m, t);
    const Real limit = resistance * min_of(radius(m), radius(t)) *
                       max_of(ContactState::at(springs.state, slot).force_n, 0.0);
    const RollingCouple c =
        RollingCouple::of(s, stiffness, dot(frame.t1, turn), dot(frame.t2, turn), limit);
    springs.friction[slot] += c.friction;
    RollingState{.couple1 = c.couple1,
                 .couple2 = c.couple2,
                 .energy = c.energy,
                 .stiffness = resistance > 0 ? stiffness : 0.0,
                 .couple = c.couple1 * frame.t1 + c.couple2 * frame.t2}
        .store(rows, slot);
  }
  /// On another face the couple goes on in the new plane, no larger than gives the spring there the
  /// energy that it had.
  CDEM_HD static void turn_to(const Frame<Real>& frame, Real stiffness, RollingState& s) {
    s.couple1 = dot(s.couple, frame.t1);
    s.couple2 = dot(s.couple, frame.t2);
    const Real energy = 0.5 * (s.couple1 * s.couple1 + s.couple2 * s.couple2) / stiffness;
    const Real keep = energy > s.energy ? sqrt_of(s.energy / energy) : 1.0;
    s.couple1 *= keep;
    s.couple2 *= keep;
  }
  /// Energy that the spring of an ended contact did not return is lost.
  CDEM_HD void end(Index m, Index slot, Index before) const {
    const RollingState s = RollingState::at(rows, slot);
    if (s.energy > 0)
      springs.friction[slot] += s.energy - 0.5 * dot(s.couple, relative_turn(m, before));
    RollingState{0, 0, 0, 0, {0.0, 0.0, 0.0}}.store(rows, slot);
  }
  CDEM_HD Real radius(Index x) const { return face_radius[exposed_face[x]]; }
  /// Rotation of face m against face t in the step.
  CDEM_HD Vec3<Real> relative_turn(Index m, Index t) const { return turn_of(m) - turn_of(t); }
  CDEM_HD Vec3<Real> turn_of(Index x) const {
    const FaceVertices<Index> corners = geometry.vertices(x);
    FaceShape<Real> middle = faces.shape(corners);
    Vec3<Real> moved[4];
    for (Index j = 0; j < 4; ++j) {
      moved[j] = faces.dt * faces.nodes.velocity(corners.node[j]);
      middle.x[j] = middle.x[j] - 0.5 * moved[j];
    }
    return FaceRotation::of(middle).turned(moved);
  }
};

/// Add, for one exposed face, the couples of its own semi-springs and the opposite of all others
/// that have it as target, in the order in which AccumulateFaceForces sums forces.
struct AddRollingCouples {
  ContactsOf contacts;
  FaceColumns faces;
  FaceGeometry geometry;
  const Flag* listed;  // [exposed] 0: idle, on no list
  ContactsByTarget acting;
  const Real* rows;    // of RollingState
  Real* corner_force;  // row of 4 per vertex: force x y z [N], stiffness of its contacts [N/m]

  CDEM_HD void operator()(One m) const {
    if (!listed[m.i]) return;
    Vec3<Real> couple{0.0, 0.0, 0.0};
    Real stiffness = 0;
    for (Index slot = 4 * m.i; slot < 4 * m.i + 4; ++slot) {
      if (contacts.springs.target[slot] < 0) continue;
      const RollingState s = RollingState::at(rows, slot);
      couple = couple + s.couple;
      stiffness += s.stiffness;
    }
    for (Index c = acting.first[m.i]; c < acting.first[m.i + 1]; ++c) {
      const Index slot = acting.contact[c];
      if (slot >= 4 * contacts.exposed) break;
      const RollingState s = RollingState::at(rows, slot);
      couple = couple - s.couple;
      stiffness += s.stiffness;
    }
    if (!(stiffness > 0)) return;
    const FaceRotation face = FaceRotation::of(faces.shape(geometry.vertices(m.i)));
    const Real on_node = stiffness / face.lever_squared();
    for (Index k = 0; k < face.count; ++k) {
      const Vec3<Real> force = face.force(k, couple);
      Real* row = corner_force + (std::size_t(m.i) * 4 + k) * 4;
      row[0] += force.x, row[1] += force.y, row[2] += force.z, row[3] += on_node;
    }
  }
};

}  // namespace cdem
