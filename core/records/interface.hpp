// interface.hpp - data of every interface, for any law.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// Law of the interface between two classes of faces, and stiffness of its contacts. A stiffness is
/// `value` [Pa/m] where that is positive, else `factor` times the modulus over the element height
/// [Pa/m]: of both sides in series, or of the stiffer one. Bonds bring their own stiffness.
struct Interface {
  Index law;       // number in InterfaceLaws
  bool in_series;  // sides
  Real stiffness_n_value, stiffness_n_factor;
  Real stiffness_s_value, stiffness_s_factor;
  Real rolling_resistance = 0;          // mu_r: couples on contacts up to mu_r R F_n
  Real returned_n = 1, returned_s = 1;  // e^2: share of the work of loading that contacts give back
  bool asks_area = false;  // does its law ask for the area of contacts? see note_interfaces

  /// Normal and shear stiffness between sides whose elements have these stiffnesses.
  CDEM_HD Real stiffness_n(Real a, Real b) const {
    return stiffness_n_value > 0 ? stiffness_n_value : stiffness_n_factor * between(a, b);
  }
  CDEM_HD Real stiffness_s(Real a, Real b) const {
    return stiffness_s_value > 0 ? stiffness_s_value : stiffness_s_factor * between(a, b);
  }
  /// Do contacts unload stiffer than they load?
  CDEM_HD bool is_hysteretic() const { return returned_n < 1 || returned_s < 1; }

 private:
  CDEM_HD Real between(Real a, Real b) const {
    return in_series ? 2 * a * b / (a + b) : max_of(a, b);
  }
};

/// Common properties of all interfaces of a model.
struct InterfaceTraits {
  unsigned laws = 0, curved = 0;  // see InterfaceTable
  bool has_state = false;         // the same
  bool hysteretic = false;        // does any ask for restitution, or close by a curve?
  bool rolls = false;             // does any resist rolling?
  bool ask_area = false;          // does any ask for the area of contacts?
};

}  // namespace cdem
