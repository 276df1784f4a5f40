// conforming_transfer.hpp - kernel that gives the force of conforming pairs to semi-springs.
#pragma once

#include "core/bonds/bonded_pairs.hpp"
#include "core/bonds/broken_pairs.hpp"
#include "core/bonds/handed_over.hpp"

namespace cdem {

/// A bond point of a conforming pair that is released while it is pressed, on half of its area:
/// the other half is for the face across.
struct ReleasedPoint {
  Index node[2];       // of either face
  Vec3<Real> apart;    // of those, one step ago  [m]
  Real depth, kn, ks;  // of its spring  [m], [N/m]
  Vec3<Real> strain;   // of its shear spring  [m]
  bool lifted;         // its spring is free of stress at a gap
  Index vertex[2];     // of either face, if that goes on as a contact, else -1
  Real share[2];       // of the force of the point, in halves
};

/// Give the springs of listed pairs, which are released, the force that their bond points carried;
/// hinges give none. See transfer_to_contact.
struct TransferToContacts {
  const Index* released;
  FaceColumns faces;
  SearchRules rules;
  PairLengths lengths;
  InIndices nodes;  // [2 * points][pair]
  Index points;     // of a pair
  PairColumns bonds;
  const Real* face_stiffness;  // of the element behind  [Pa/m]
  Index *target, *target_before;
  Real* springs;  // rows of ContactState

  CDEM_HD void operator()(One item) const {
    const One pair{released[item.i]};
    if (bonds.are_hinges(pair)) return;
    ReleasedPoint found[4];
    const Index count = list_points(pair, found);
    share_out(found, count);
    bonds.stored.set(0, pair, bonds.stored.at(0, pair) - hand_over(pair, found, count));
  }

 private:
  CDEM_HD Index face(One pair, Index side) const { return lengths.faces[2 * pair.i + side]; }
  /// Area of half a bond point  [m2].
  CDEM_HD Real area(One pair) const { return 0.5 * bonds.area.at(0, pair) / points; }

  /// Points of a pair one step ago; how many.
  CDEM_HD Index list_points(One pair, ReleasedPoint* found) const {
    const Frame<Real> frame = faces.shape_before(face(pair, 0)).frame();
    Index count = 0;
    for (Index k = 0; k < points; ++k)
      if (read_point(pair, k, frame, found[count])) ++count;
    return count;
  }
  /// Has point k a force to carry over?
  CDEM_HD bool read_point(One pair, Index k, const Frame<Real>& frame, ReleasedPoint& point) const {
    for (Index side = 0; side < 2; ++side) point.node[side] = nodes.at(side * points + k, pair);
    point.apart = faces.position_before(point.node[1]) - faces.position_before(point.node[0]);
    const Vec3<Real> jump = bonds.past_rest(pair, k, points, frame, point.apart);
    if (dot(frame.n, jump) >= 0) return false;  // open
    if (norm(point.apart) > 2 * rules.indentation * lengths.at(pair.i)) return false;
    const JointStiffness<Real> stiffness = bonds.spring(pair, area(pair)).stiffness;
    const Vec3<Real> slip = bonds.slip1.at(k, pair) * frame.t1 + bonds.slip2.at(k, pair) * frame.t2;
    const Vec3<Real> along = jump - dot(frame.n, jump) * frame.n;
    point.depth = -dot(frame.n, jump);
    const Index interface = bonds.interface.at(0, pair);
    if (bonds.interfaces.closes_by_curve(interface)) {  // of a straight spring with its force
      const auto laws = joint_laws<InterfaceLaws>(bonds.interfaces, interface);
      point.depth = laws.close(point.depth, stiffness).pressure / stiffness.n;
    }
    point.kn = area(pair) * stiffness.n;
    point.ks = area(pair) * stiffness.s;
    point.strain = along - slip;
    point.lifted = bonds.lift(pair, k) > 0;
    for (Index side = 0; side < 2; ++side) {
      const Index own = face(pair, side), v = vertex_at(own, point.node[side]);
      const bool stays = !point.lifted || is_over(rules, faces, own, v, face(pair, 1 - side));
      point.vertex[side] = stays ? v : -1;
    }
    return true;
  }
  CDEM_HD Index vertex_at(Index of, Index node) const {
    for (Index v = 0; v < faces.vertex_count(of); ++v)
      if (faces.vertex(of, v) == node) return v;
    return -1;
  }

  /// Of a lifted point, what a vertex leaves that has slid off its face goes to the other one;
  /// where both have, to the other points.
  CDEM_HD static void share_out(ReleasedPoint* found, Index count) {
    Real all = 0, borne = 0;
    for (Index k = 0; k < count; ++k) {
      ReleasedPoint& point = found[k];
      const Index staying = (point.vertex[0] >= 0) + (point.vertex[1] >= 0);
      for (Real& share : point.share) share = staying == 1 ? 2 : 1;
      all += point.kn * point.depth;
      if (staying > 0) borne += point.kn * point.depth;
    }
    if (!(borne > 0) || borne == all) return;
    for (Index k = 0; k < count; ++k)
      for (Real& share : found[k].share) share *= all / borne;
  }

  /// Returns the energy that the springs hold  [J].
  CDEM_HD Real hand_over(One pair, const ReleasedPoint* found, Index count) const {
    const Interface& contact = bonds.interfaces.interfaces[bonds.interface.at(0, pair)];
    const Real side_a = face_stiffness[face(pair, 0)], side_b = face_stiffness[face(pair, 1)];
    const auto k = JointStiffness<Real>::of(contact.stiffness_n(side_a, side_b),
                                            contact.stiffness_s(side_a, side_b));
    const Frame<Real> frame[2] = {faces.shape_before(face(pair, 0)).frame(),
                                  faces.shape_before(face(pair, 1)).frame()};
    Real handed = 0;
    for (Index p = 0; p < count; ++p)
      for (Index side = 0; side < 2; ++side)
        if (found[p].vertex[side] >= 0) handed += give(pair, found[p], side, frame, contact, k);
    return handed;
  }
  /// Let the vertex of a side begin as a semi-spring. Returns the energy that it holds  [J].
  CDEM_HD Real give(One pair, const ReleasedPoint& point, Index side, const Frame<Real>* frame,
                    const Interface& contact, const JointStiffness<Real>& k) const {
    const Real kn = area(pair) * k.n, ks = area(pair) * k.s;
    // of the force: no deeper than the faces are, but lifted ones need not be deep
    const Real part = point.share[side] * (point.lifted ? 1 : min_of(1.0, kn / point.kn));
    const Real deeper =
        point.share[side] * (point.lifted ? point.kn / kn : min_of(1.0, point.kn / kn));
    const Vec3<Real> force = (side == 0 ? part : -part) * point.ks * point.strain;
    const Frame<Real>& across = frame[1 - side];
    ContactState spring{};
    spring.shear1 = dot(force, across.t1);
    spring.shear2 = dot(force, across.t2);
    spring.penetration = deeper * point.depth;
    spring.stress_free_gap = spring.penetration + dot(frame[0].n, point.apart);
    spring.approach = spring.penetration;
    spring.force_n = kn * spring.penetration;
    spring.energy_n = contact.returned_n * 0.5 * kn * spring.penetration * spring.penetration;
    press(bonds.interfaces, bonds.interface.at(0, pair), area(pair), k, spring);
    spring.energy_s = contact.returned_s * 0.5 / ks *
                      (spring.shear1 * spring.shear1 + spring.shear2 * spring.shear2);
    const Index slot = 4 * faces.face_exposed[face(pair, side)] + point.vertex[side];
    target[slot] = target_before[slot] = faces.face_exposed[face(pair, 1 - side)];
    spring.store(springs, slot);
    return spring.energy_n + spring.energy_s;
  }
};

}  // namespace cdem
