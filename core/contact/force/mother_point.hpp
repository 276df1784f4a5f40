// mother_point.hpp - the point of the mother face at which a semi-spring acts.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// The acting point: the vertex, moved towards the face's centre by the action coefficient, or by
/// more where the contact is held at a rim, see HoldAtRims.
template <class T>
struct MotherPoint {
  Vec3<T> x, x_old, v;  // now, one step ago; velocity
  T inverse_mass;       // under a force: sum w^2 / m  [1/kg]

  /// The point of a slot (4 * exposed face + vertex) of exposed face m.
  template <class Ids>
  CDEM_HD static MotherPoint at(const FaceColumns& faces, const FaceGeometry& geometry,
                                const SearchRules& rules, const Real* rim_action,
                                const Real* node_mass, const Ids& m, const Ids& slot) {
    const T dt(faces.dt), zero(0.0);
    const Vec3<T> none{zero, zero, zero};
    MotherPoint p{.x = none, .x_old = none, .v = none, .inverse_mass = zero};
    const auto add = [&](const Ids& node, const T& w) {
      const Vec3<T> x = faces.nodes.position(node), v = faces.nodes.velocity(node);
      p.x = p.x + w * x;
      p.x_old = p.x_old + w * (x - dt * v);
      p.v = p.v + w * v;
      p.inverse_mass += w * w / look_up(node_mass, node);
    };
    const T action = max_of(T(rules.action), look_up(rim_action, slot));
    if (!any_of(action > zero)) {
      const auto corner = [&](Index x, Index s) { return geometry.table[x].corner[s % 4]; };
      add(indices_of(corner, m, slot), T(1.0));
      return p;
    }
    const FaceVertices<Ids> corners = geometry.vertices(m);
    for (Index j = 0; j < 4; ++j) {
      const auto share = [&](Index x, Index s) {
        return share_of(max_of(rules.action, rim_action[s]), geometry.table[x].count(), s % 4, j);
      };
      add(corners.node[j], numbers_of(share, m, slot));
    }
    return p;
  }

 private:
  /// Weight of vertex j, of this number, in the acting point of vertex k.
  CDEM_HD static Real share_of(Real action, Index count, Index k, Index j) {
    if (j >= count) return 0.0;
    return action / Real(count) + (j == k ? 1.0 - action : 0.0);
  }
};

}  // namespace cdem
