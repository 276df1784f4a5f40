// soft_rim.hpp - soft contacts stay on a face whose rim their vertex has passed.
#pragma once

#include "core/contact/narrow_phase/target_face.hpp"

namespace cdem {

/// Keep soft contacts of one exposed face that ResolveTargets let go over a rim: the way that they
/// would take to bear again is not small against the indentation. Their acting point stays at the
/// rim, as far beyond it as the vertex was before.
struct HoldAtRims : FaceSearch {
  CDEM_HD void operator()(One m) const {
    const Flag* unresolved = springs.unresolved + 4 * m.i;
    if (!(unresolved[0] | unresolved[1] | unresolved[2] | unresolved[3])) return;
    for (Index k = 0; k < 4; ++k) {
      const Index slot = 4 * m.i + k, before = springs.target_before[slot];
      if (springs.target[slot] >= 0 || before < 0) continue;
      const Real action = action_at_rim(m.i, k, before);
      if (action < 0) continue;
      springs.rim_action[slot] = action;
      springs.target[slot] = before;
    }
  }

  /// The action coefficient of vertex k of exposed face m on face t, if it is held there, or -1.
  CDEM_HD Real action_at_rim(Index m, Index k, Index t) const {
    const Index slot = 4 * m + k, node = faces.vertex(exposed_face[m], k);
    const ContactState state = ContactState::at(springs.state, slot);
    const Real length = min_of(geometry.length(m), geometry.length(t));
    const Real far = soft * rules.indentation * length;
    const Real shear = sqrt_of(state.shear1 * state.shear1 + state.shear2 * state.shear2);
    if (!(2 * state.energy_s > far * shear)) return -1;
    const Vec3<Real> n = geometry.normal(t);
    const bool one_body = faces.body[node] == faces.body[faces.vertex(exposed_face[t], 0)];
    if (one_body || !(dot(geometry.normal(m), n) < -coplanar_faces)) return -1;
    const FaceShape<Real> f = faces.shape(exposed_face[t]);
    const Vec3<Real> v = faces.nodes.position(node), arm = geometry.center(m) - v;
    const Real inside = part_inside(f, n, v, arm);
    if (inside > furthest) return -1;
    const Real action = rules.action + max_of(inside - rules.indentation, 0.0);
    const Real gap = project(f, v + action * arm, n).gap, free = state.stress_free_gap;
    if (gap > 2 * max_of(free, 0.0) || gap < min_of(free, 0.0) - rules.depth * length) return -1;
    return action;
  }

 private:
  static constexpr Real soft = 0.3;      // of the indentation: a contact is soft that gives more
  static constexpr Real furthest = 0.9;  // part of the way to the centre of the face
  static constexpr Real nowhere = 2;     // a part that does not lead into the face

  /// The least part of the arm that leads from point v into a face.
  CDEM_HD static Real part_inside(const FaceShape<Real>& f, const Vec3<Real>& n,
                                  const Vec3<Real>& v, const Vec3<Real>& arm) {
    Real least = 0, most = 1;
    for (Index k = 0; k < f.count(); ++k) {
      const Vec3<Real> across = cross(f.x[k + 1 == f.count() ? 0 : k + 1] - f.x[k], n);
      const Real out = dot(across, v - f.x[k]), rise = dot(across, arm);
      if (out > 0 && !(out + rise < 0)) return nowhere;
      if (out > 0)
        least = max_of(least, -out / rise);
      else if (out + rise > 0)
        most = min_of(most, -out / rise);
    }
    return least < most ? least : nowhere;
  }
};

}  // namespace cdem
