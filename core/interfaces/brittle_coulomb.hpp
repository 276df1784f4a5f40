// brittle_coulomb.hpp - the limit of an interface's force: tension cut-off and Mohr-Coulomb,
// brittle.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// Properties of the interface between two groups.
///
/// A stiffness is `value` [Pa/m] when that is positive, else `factor` times the stiffer side's
/// modulus over its element height [Pa/m].
struct Interface {
  Real cohesion;          // c         [Pa]
  Real tensile_strength;  // T         [Pa]
  Real tan_friction;      // tan(phi)  [-]
  Real stiffness_n_value, stiffness_n_factor;
  Real stiffness_s_value, stiffness_s_factor;
  Real tan_dilation;   // tan(psi): opening per slip of a sliding contact  [-]
  Real dilation_most;  // opening at which it dilates no more  [m]

  CDEM_HD Real stiffness_n(Real auto_stiffness) const {
    return stiffness_n_value > 0 ? stiffness_n_value : stiffness_n_factor * auto_stiffness;
  }
  CDEM_HD Real stiffness_s(Real auto_stiffness) const {
    return stiffness_s_value > 0 ? stiffness_s_value : stiffness_s_factor * auto_stiffness;
  }
};

/// Limits of the force of one bond or contact. Feng et al. (2014), Eq. 14.
///
///   opens  when  -Fn > T A                   then  Fn = Fs = 0
///   slips  when  |Fs| > Fn tan(phi) + c A    then  |Fs| = Fn tan(phi) + c A
///   and from the next step on  c = T = 0
///
/// Fn > 0 is compression; `bond` is 1 while intact, then 0. Departure from the paper: `>` for its
/// `>=`, and a millionth of c added to T, so that an unloaded contact with T = 0 (or c = 0) keeps
/// its other strength in spite of round-off.
template <class T>
struct ForceLimit {
  T tension, shear;  // [N]

  CDEM_HD ForceLimit(T tension_limit, T cohesion_limit, T tan_friction, T bond, T force_n) {
    constexpr Real round_off = 1e-6;  // of the cohesion
    tension = bond * (tension_limit + T(round_off) * cohesion_limit);
    shear = max_of(force_n * tan_friction + bond * cohesion_limit, T(0.0));
  }
  CDEM_HD auto opens(T force_n) const { return -force_n > tension; }
  CDEM_HD auto slips(T shear_squared) const { return shear_squared > shear * shear; }
};

/// Bring the force of one contact back to its limit.
template <class T>
CDEM_HD inline void limit_force(T tension_limit, T cohesion_limit, T tan_friction, T& bond,
                                T& force_n, T& force_s1, T& force_s2) {
  const T none(0.0), all(1.0);
  const ForceLimit<T> limit(tension_limit, cohesion_limit, tan_friction, bond, force_n);
  const T squared = force_s1 * force_s1 + force_s2 * force_s2;
  const auto opens = limit.opens(force_n), slips = limit.slips(squared);
  const T keep = select(opens, none, select(slips, limit.shear / sqrt_of(squared), all));
  force_n = select(opens, none, force_n);
  force_s1 = keep * force_s1;
  force_s2 = keep * force_s2;
  bond = select(opens | slips, none, bond);
}

}  // namespace cdem
