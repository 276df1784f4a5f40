// contact_laws.hpp - interfaces of contacts by pair of face classes.
#pragma once

#include "core/contact/force/contact_spring.hpp"
#include "core/contact/geometry/face_geometry.hpp"
#include "core/contact/geometry/face_interfaces.hpp"
#include "core/interfaces/table.hpp"

namespace cdem {

/// Interfaces by pair of classes of faces, and the contact dashpot.
struct ContactLaws {
  FaceInterfaces faces;
  InterfaceTable interfaces;
  Real damping_ratio;     // of critical, on the effective mass of the two points
  const Real* node_mass;  // [kg]

  /// The interface between two exposed faces, or between one and another a lane.
  template <class Ids>
  CDEM_HD auto between(const FaceGeometry& geometry, const Ids& m, const Ids& t) const {
    return faces.between(geometry.table, m, t);
  }
  /// Spring of a contact of theirs on its characteristic area.
  template <class Ids>
  CDEM_HD auto spring(const FaceGeometry& geometry, const Ids& interface, const Ids& m,
                      const Ids& t) const {
    const Interface* table = interfaces.interfaces;
    const auto area = [&](Index a, Index b) { return geometry.contact_area(a, b); };
    const auto normal = [&](Index l, Index a, Index b) {
      return table[l].stiffness_n(geometry.stiffness(a), geometry.stiffness(b));
    };
    const auto shear = [&](Index l, Index a, Index b) {
      return table[l].stiffness_s(geometry.stiffness(a), geometry.stiffness(b));
    };
    using T = Number<Ids>;
    return ContactSpring<T>{.area = numbers_of(area, m, t),
                            .stiffness = JointStiffness<T>::of(numbers_of(normal, interface, m, t),
                                                               numbers_of(shear, interface, m, t))};
  }
  /// The contact dashpot of a spring between points of this effective mass  [N s/m].
  template <class T>
  CDEM_HD T dashpot(const ContactSpring<T>& spring, const T& inverse_mass) const {
    return T(2.0 * damping_ratio) * sqrt_of(spring.n() / inverse_mass);
  }
};

}  // namespace cdem
