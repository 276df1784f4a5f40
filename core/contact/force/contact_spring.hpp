// contact_spring.hpp - stiffness of one contact.
#pragma once

#include "core/interfaces/law.hpp"

namespace cdem {

/// Spring of one contact.
template <class T>
struct ContactSpring {
  T area;  // characteristic area, Eq. 4-5  [m2]
  JointStiffness<T> stiffness;
  T has_area = T(0.0);  // 1 if the area is the joint's, see ContactAreas

  CDEM_HD T n() const { return area * stiffness.n; }  // K_n  [N/m]
  CDEM_HD T s() const { return area * stiffness.s; }  // K_s  [N/m]
  CDEM_HD T per_area() const { return T(1.0) / area; }
  CDEM_HD T compliance_s() const { return per_area() * stiffness.compliance_s; }  // 1 / K_s  [m/N]
};

}  // namespace cdem
