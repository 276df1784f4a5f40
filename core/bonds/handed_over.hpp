// handed_over.hpp - state of contacts that take over the force of a released pair.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"
#include "core/interfaces/laws.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// Is the indented point of a vertex of face `mother` beside face `target`?
CDEM_HD inline bool is_over(const SearchRules& rules, const FaceColumns& faces, Index mother,
                            Index vertex, Index target) {
  const FaceShape<Real> from = faces.shape(mother), to = faces.shape(target);
  const Vec3<Real> v = from.x[vertex], p = v + rules.indentation * (from.center() - v);
  const Real length = min_of(faces.face_length[mother], faces.face_length[target]);
  return to.inside(p, to.normal(), rules.tolerance * length);
}

/// Let a contact on this area, which has its force, have the depth and energy of its law.
CDEM_HD inline void press(const InterfaceTable& table, Index interface, Real area,
                          const JointStiffness<Real>& k, ContactState& contact) {
  if (!table.closes_by_curve(interface)) return;
  const Real gap = contact.stress_free_gap - contact.approach;
  contact.approach = depth_under(table, interface, contact.force_n / area, k);
  contact.stress_free_gap = gap + contact.approach;
  contact.energy_n =
      area * joint_laws<InterfaceLaws>(table, interface).close(contact.approach, k).stored;
}

}  // namespace cdem
