// closure.hpp - the normal spring of a pressed joint: straight, or of a law whose joints
// close.
#pragma once

#include "core/base/elementary.hpp"
#include "core/interfaces/law.hpp"

namespace cdem {

/// A pressed joint.
template <class T>
struct Closure {
  T pressure;  // compression > 0  [Pa]
  T stored;    // energy  [J/m2]
};

/// Does a law have a normal spring of its own, which is curved?
template <template <class> class Law>
inline constexpr bool is_curved = requires(const Law<Real>& law, const JointStiffness<Real>& k) {
  law.close(Real(0), k);
  law.depth(Real(0), k);
};

/// The straight one.
template <class T>
CDEM_HD inline Closure<T> close_straight(const T& depth, const JointStiffness<T>& k) {
  const T pressure = k.n * depth;
  return {pressure, T(0.5) * pressure * depth};
}

/// A hyperbola (Bandis, Lumsden & Barton 1983) that goes on as a straight line where it is as stiff
/// as the joint's k_n:
///
///   sigma = k_i d / (1 - d / V_m),    d sigma / d d = k_i / (1 - d / V_m)^2 <= k_n
///
/// So k_n is the largest stiffness, for which the step is found. A k_n below k_i leaves no curve.
template <class T>
struct HyperbolicClosure {
  T initial;  // k_i  [Pa/m]
  T most;     // V_m  [m]

  CDEM_HD Closure<T> close(const T& depth, const JointStiffness<T>& k) const {
    const T half(0.5), one(1.0), stiffness = min_of(initial, k.n);
    const T curved = min_of(depth, last(k)), beyond = depth - curved;
    const T left = one - curved / most;  // of V_m
    const T pressure = stiffness * curved / left;
    const T stored = -stiffness * most * (curved + most * log_of(left));
    return {pressure + k.n * beyond,
            max_of(stored, T(0.0)) + beyond * (pressure + half * k.n * beyond)};
  }
  CDEM_HD T depth(const T& pressure, const JointStiffness<T>& k) const {
    const T stiffness = min_of(initial, k.n), end = last(k);
    const T most_curved = stiffness * end / (T(1.0) - end / most);
    const T curved = min_of(pressure, most_curved);
    return curved / (stiffness + curved / most) + (pressure - curved) * k.compliance_n;
  }
  /// The pressure at which the curve ends  [Pa].
  CDEM_HD T end(const T& stiffness_n) const {
    const T ratio = max_of(stiffness_n / initial, T(1.0));
    return initial * most * (sqrt_of(ratio) - T(1.0));
  }
  /// How stiff it is under a pressure  [Pa/m].
  CDEM_HD T tangent(const T& pressure, const JointStiffness<T>& k) const {
    const T more = T(1.0) + pressure / (initial * most);
    return min_of(min_of(initial, k.n) * more * more, k.n);
  }

 private:
  /// The depth at which the hyperbola ends  [m].
  CDEM_HD T last(const JointStiffness<T>& k) const {
    const T one(1.0);
    return most * (one - sqrt_of(min_of(initial * k.compliance_n, one)));
  }
};

}  // namespace cdem
