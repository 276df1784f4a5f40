// contact_laws.hpp - interfaces of contacts by pair of face classes.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"
#include "core/interfaces/brittle_coulomb.hpp"

namespace cdem {

/// Interfaces by pair of groups, and the contact dashpot.
struct ContactLaws {
  const Index* interface_of;  // [group_m * class_count + group_t]
  const Interface* interfaces;
  Index class_count;
  Real damping_ratio;     // of critical, on the effective mass of the two points
  const Real* node_mass;  // [kg]

  /// The interface between two exposed faces, or between one and another a lane.
  template <class Ids>
  CDEM_HD auto between(const FaceGeometry& geometry, const Ids& m, const Ids& t) const {
    return indices_of(
        [&](Index a, Index b) {
          return interface_of[geometry.table[a].interface_class * class_count +
                              geometry.table[b].interface_class];
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

}  // namespace cdem
