// interface.hpp - what every interface has, whatever its law.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// Law and stiffness of the interface between two classes of faces. A stiffness is `value` [Pa/m]
/// where that is positive, else `factor` times the stiffer side's modulus over its element height
/// [Pa/m].
struct Interface {
  Index law;  // number in InterfaceLaws
  Real stiffness_n_value, stiffness_n_factor;
  Real stiffness_s_value, stiffness_s_factor;

  CDEM_HD Real stiffness_n(Real auto_stiffness) const {
    return stiffness_n_value > 0 ? stiffness_n_value : stiffness_n_factor * auto_stiffness;
  }
  CDEM_HD Real stiffness_s(Real auto_stiffness) const {
    return stiffness_s_value > 0 ? stiffness_s_value : stiffness_s_factor * auto_stiffness;
  }
};

}  // namespace cdem
