// falling_friction.hpp - what laws share whose friction falls from a peak to a residual value.
#pragma once

#include "core/records/law_declaration.hpp"

namespace cdem {

/// Friction after the fall.
inline constexpr Parameter residual_friction_angle{.name = "residual_friction_angle",
                                                   .symbol = "phi_r",
                                                   .unit = "deg",
                                                   .meaning = "Friction angle after the fall",
                                                   .below = 90,
                                                   .form = Form::tangent,
                                                   .is_strength = true};
/// The same where a case may be silent: friction does not fall then.
inline constexpr Parameter optional_residual_friction_angle = [] {
  Parameter p = residual_friction_angle;
  p.like = "friction_angle";
  return p;
}();

/// Why a residual friction does not fit the peak one and dilation (tangents), or nullptr.
inline const char* contradiction_of_residual(double peak, double dilation, double residual) {
  if (residual > peak)
    return "residual_friction_angle must not be larger than friction_angle, {friction_angle:g}";
  if (dilation > residual)
    return "dilation_angle must not be larger than residual_friction_angle, "
           "{residual_friction_angle:g}";
  return nullptr;
}

}  // namespace cdem
