// falling_friction.hpp - common code of laws whose friction falls from a peak to a residual value.
#pragma once

#include "core/interfaces/law.hpp"

namespace cdem {

/// Friction after the fall.
inline constexpr Parameter residual_friction_angle{.name = "residual_friction_angle",
                                                   .symbol = "phi_r",
                                                   .unit = "deg",
                                                   .meaning = "Residual friction angle",
                                                   .below = 90,
                                                   .form = Form::tangent,
                                                   .is_strength = true};
/// The same where a case may be silent: friction does not fall then.
inline constexpr Parameter optional_residual_friction_angle = [] {
  Parameter p = residual_friction_angle;
  p.like = "friction_angle";
  return p;
}();
inline constexpr Parameter slip_distance{.name = "slip_distance",
                                         .symbol = "Dc",
                                         .unit = "m",
                                         .meaning = "Slip over which friction falls"};
inline constexpr Parameter residual_cohesion{
    .name = "residual_cohesion",
    .symbol = "c_r",
    .unit = "Pa",
    .meaning = "Cohesion of a broken bond while its faces are pressed",
    .otherwise = 0,
    .is_strength = true,
    .scatter = 1};

inline constexpr StateVariable joint_slip{
    .name = "joint_slip", .unit = "m", .meaning = "Slip of the joint"};

/// Why a residual friction does not fit the peak one and dilation (tangents), or nullptr.
inline const char* contradiction_of_residual(double peak, double dilation, double residual) {
  if (residual > peak)
    return "residual_friction_angle must not be larger than friction_angle, {friction_angle:g}";
  if (dilation > residual)
    return "dilation_angle must not be larger than residual_friction_angle, "
           "{residual_friction_angle:g}";
  return nullptr;
}

/// tan(phi) that falls in a straight line from its peak to its residual value over a slip.
template <class T>
struct FallingFriction {
  T peak, residual;  // tangents
  T distance;        // [m]

  CDEM_HD T tangent(const T& slip) const {
    const T left = max_of(T(1.0) - slip / over(), T(0.0));
    return residual + (peak - residual) * left;
  }
  /// How much it falls per slip at this slip  [1/m].
  CDEM_HD T fall(const T& slip) const {
    return select(slip < distance, (peak - residual) / over(), T(0.0));
  }

 private:
  CDEM_HD T over() const { return max_of(distance, T(1e-300)); }
};

/// Slip of a step that brings a trial traction down to a limit which falls with that slip: in a
/// straight line with up to two corners, after which it is `last`. Newton's steps from the right:
/// the excess over the limit is concave, so that they end on the one line that has the root, also
/// where the limit falls more steeply than the joint unloads and the traction has to jump.
template <class T, class Limit, class Fall>
CDEM_HD inline T slip_down_to(const T& trial, const T& stiffness, const T& last,
                              const Limit& limit_after, const Fall& fall_after) {
  const T none(0.0), least = T(1e-6) * stiffness;
  T slip = max_of((trial - last) / stiffness, none);
  for (int corner = 0; corner < 2; ++corner) {
    const T beyond = min_of(trial - stiffness * slip - limit_after(slip), none);
    slip = max_of(slip + beyond / max_of(stiffness - fall_after(slip), least), none);
  }
  return slip;
}

/// The answer of the brittle law with friction that falls with the slip, within the step already.
/// `coheres` as there.
template <class Law, class T>
CDEM_HD inline JointAnswer<T> respond_falling(Law brittle, const FallingFriction<T>& friction,
                                              const JointInput<T>& in, const T& coheres, T& slip) {
  const T none(0.0), half(0.5);
  const JointStiffness<T>& k = in.stiffness;
  const T elastic = -k.n * in.opening;
  const T pressed = max_of(select(in.bond > half, elastic, elastic + in.damping), none);
  const T try1 = -k.s * in.shear1, try2 = -k.s * in.shear2;
  const T trial = sqrt_of(try1 * try1 + try2 * try2);
  const T cohesion = coheres * brittle.cohesion;
  const auto limit_after = [&](const T& more) {
    return cohesion + pressed * friction.tangent(slip + more);
  };
  const auto fall_after = [&](const T& more) { return pressed * friction.fall(slip + more); };
  const T more =
      slip_down_to(trial, k.s, cohesion + pressed * friction.residual, limit_after, fall_after);
  const auto slides = trial > limit_after(none);
  brittle.tan_friction = friction.tangent(slip + select(slides, more, none));
  const JointAnswer<T> answer =
      brittle.respond_within(in, coheres, [](const T& limit) { return limit; });
  const T left = sqrt_of(answer.shear1 * answer.shear1 + answer.shear2 * answer.shear2);
  slip +=
      select(slides & (answer.normal > none), k.compliance_s * max_of(trial - left, none), none);
  return answer;
}

}  // namespace cdem
