// change_of_target.hpp - semi-springs that move to another face, or whose contact ends.
#pragma once

#include "core/contact/force/contact_laws.hpp"
#include "core/contact/force/mother_point.hpp"
#include "core/contact/narrow_phase/closed_contact.hpp"
#include "core/contact/narrow_phase/contact_columns.hpp"

namespace cdem {

/// Move or close the contacts of one exposed face that have no longer the target of one step ago.
/// The histories of its vertices stay: they belong to the wall.
struct ChangeTargets {
  FaceColumns faces;
  FaceGeometry geometry;
  SearchRules rules;
  ContactLaws laws;
  SpringColumns springs;

  CDEM_HD void operator()(One m) const {
    bool changes = false;
    for (Index k = 0; k < 4; ++k)
      changes |= springs.target[4 * m.i + k] != springs.target_before[4 * m.i + k];
    if (!changes) return;
    for (Index slot = 4 * m.i; slot < 4 * m.i + 4; ++slot) {
      const Index t = springs.target[slot], before = springs.target_before[slot];
      if (before < 0 || t == before) continue;
      if (t < 0)
        close_contact(m.i, slot, before);
      else
        move_to_target(m.i, slot, before, t);
    }
  }

 private:
  /// A contact that changes its face keeps the shear force, turned into the new plane with its
  /// length kept, and penetrates as far as gives the normal spring there the energy it had: as deep
  /// as before would make some where the new face is the stiffer one. Where it has unloaded, its
  /// approach is scaled alike. Until it has its new force, its energies are those of its springs
  /// on the old face, as far as not returned.
  CDEM_HD void move_to_target(Index m, Index slot, Index before, Index t) const {
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
    const bool unloaded = s.approach > s.penetration;
    const Real kn = storing_stiffness(m, t);
    s.penetration = sqrt_of(2 / kn * s.energy_n);
    s.approach = unloaded ? sqrt_of(storing_stiffness(m, before) / kn) * s.approach : s.penetration;
    s.energy_n = left.dashpot;
    s.energy_s = left.friction;
    s.store(springs.state, slot);
  }
  /// Of the energy that a normal spring gives back, by its effective penetration  [N/m].
  CDEM_HD Real storing_stiffness(Index m, Index t) const {
    const Index interface = laws.between(geometry, m, t);
    return 0.5 * laws.spring(geometry, interface, m, t).n() * laws.faces.returned_n(interface);
  }
  /// Reset the forces of an ended contact.
  CDEM_HD void close_contact(Index m, Index slot, Index before) const {
    const DissipatedAtEnd lost = lost_on(m, slot, before);
    springs.friction[slot] += lost.friction;
    springs.dashpot[slot] += lost.dashpot;
    ContactState{}.store(springs.state, slot);
    Real* row = springs.reaction + std::size_t(slot) * 8;
    row[0] = row[1] = row[2] = row[3] = 0;
  }
  /// Energy of springs on a face that they have left, not returned.
  CDEM_HD DissipatedAtEnd lost_on(Index m, Index slot, Index before) const {
    const FaceVertices<Index> corners = geometry.vertices(before);
    FaceShape<Real> shape = faces.shape(corners);
    Vec3<Real> moved[4];
    for (Index j = 0; j < 4; ++j) {
      moved[j] = faces.dt * faces.nodes.velocity(corners.node[j]);
      shape.x[j] = shape.x[j] - moved[j];
    }
    const Frame<Real> frame = shape.frame();
    const auto mother =
        MotherPoint<Real>::at(faces, geometry, rules, springs.rim_action, laws.node_mass, m, slot);
    const Projection<Real> foot = project(shape, mother.x_old, frame.n);
    Vec3<Real> displacement = mother.x - mother.x_old;
    for (Index j = 0; j < 4; ++j) displacement = displacement - foot.weight[j] * moved[j];
    const Real returned = laws.faces.returned_n(laws.between(geometry, m, before));
    return {ContactState::at(springs.state, slot), returned, frame, displacement};
  }
};

}  // namespace cdem
