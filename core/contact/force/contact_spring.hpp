// contact_spring.hpp - stiffness of one contact.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// Spring of one contact.
template <class T>
struct ContactSpring {
  T area;                      // characteristic area, Eq. 4-5  [m2]
  T stiffness_n, stiffness_s;  // [Pa/m]

  CDEM_HD T n() const { return area * stiffness_n; }  // K_n  [N/m]
  CDEM_HD T s() const { return area * stiffness_s; }  // K_s  [N/m]
};

}  // namespace cdem
