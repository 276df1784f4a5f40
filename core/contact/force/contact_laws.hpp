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
  Real damping_ratio;              // of critical, on the effective mass of the two points
  const Real* node_mass;           // [kg]
  const Real* area_per_stiffness;  // [exposed] see ShareAreas; null where no law asks for it

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
  /// May a contact have area? Its faces are within 20 degrees of parallel; else a corner or an edge
  /// of one meets the other, and shares of theirs belong to contacts with other faces.
  template <class Ids>
  CDEM_HD auto have_area(const FaceGeometry& geometry, const Ids& m, const Ids& t) const {
    return dot(geometry.normal(m), geometry.normal(t)) < Number<Ids>(-parallel);
  }
  /// Let the spring of a contact that was pressed one step ago have the area that is in contact, if
  /// its law asks for that. A straight spring keeps its stiffness, so that area changes strength
  /// alone; a curve is of tractions, and goes with the area.
  template <class Laws, class Ids, class T>
  CDEM_HD void take_true_area(ContactSpring<T>& spring, const FaceGeometry& geometry,
                              const Ids& interface, const Ids& m, const Ids& t,
                              const Truth<T>& pressed) const {
    if constexpr (Laws::count > 1) {
      if (!area_per_stiffness) return;
      const Interface* table = interfaces.interfaces;
      const T none(0.0), one(1.0);
      const auto asks =
          numbers_of([&](Index i) { return table[i].asks_area ? 1.0 : 0.0; }, interface) > none;
      const T area = look_up(area_per_stiffness, m) + look_up(area_per_stiffness, t);
      const auto has = pressed & have_area(geometry, m, t);
      const T ratio = select(has, spring.stiffness.n * area, none);
      const auto curved = interfaces.closes_by_curve(interface);
      const T within = max_of(min_of(ratio, T(most_of_curve)), T(least_of_curve));
      const T larger = select(asks, select(curved, within, max_of(ratio, T(least_part))), one);
      const T softer = select(curved, one, larger);
      spring.area = larger * spring.area;
      spring.stiffness = {.n = spring.stiffness.n / softer,
                          .s = spring.stiffness.s / softer,
                          .compliance_n = softer * spring.stiffness.compliance_n,
                          .compliance_s = softer * spring.stiffness.compliance_s};
      spring.has_area = select(asks, one, none);
    }
  }
  /// The contact dashpot of a spring between points of this effective mass  [N s/m].
  template <class T>
  CDEM_HD T dashpot(const ContactSpring<T>& spring, const T& inverse_mass) const {
    return T(2.0 * damping_ratio) * sqrt_of(spring.n() / inverse_mass);
  }

 private:
  static constexpr Real parallel = 0.94;  // a cosine
  // of its share: what a corner or an edge has that touches, and what the step has room for
  static constexpr Real least_part = 1e-3, least_of_curve = 0.5, most_of_curve = 2;
};

}  // namespace cdem
