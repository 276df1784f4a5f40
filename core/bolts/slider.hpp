// slider.hpp - a spring whose force has limits: bars, grout, plates and anchors of bolts.
#pragma once

#include "core/base/math.hpp"
#include "core/bolts/states.hpp"

namespace cdem {

/// Share of its stiffness that a spring at its limit keeps within one step, so that equilibrium of
/// a bolt has one solution even where all of its grout slips. It is no hardening: what is above the
/// limit is gone in the next step.
inline constexpr Real slider_rest = 1e-6;

/// A spring of a stiffness k that is free at a place, and whose force stays between two limits.
struct Slider {
  Real stiffness, free;  // k [N/m], place without force [m]
  Real least, most;      // limits of the force  [N]

  CDEM_HD Real trial(Real x) const { return stiffness * (x - free); }

  CDEM_HD SliderState state(Real x) const {
    const Real force = trial(x);
    if (force > most) return SliderState::upper;
    return force < least ? SliderState::lower : SliderState::holds;
  }
  /// Force at x on one part of the law  [N].
  CDEM_HD Real force(Real x, SliderState on) const {
    if (on == SliderState::holds) return trial(x);
    const Real limit = on == SliderState::upper ? most : least;
    return limit + slider_rest * (trial(x) - limit);
  }
  CDEM_HD Real tangent(SliderState on) const {
    return on == SliderState::holds ? stiffness : slider_rest * stiffness;
  }
  /// Its free length after a force at x. One that can only pull goes slack: it acts again
  /// at its old length.
  CDEM_HD Real free_after(Real x, Real force) const {
    const bool slack = least == 0 && most > 0 && force < 0;
    return stiffness > 0 && !slack ? x - force / stiffness : free;
  }
  /// Elastic energy under a force  [J].
  CDEM_HD Real stored(Real force) const {
    return stiffness > 0 ? 0.5 * force * force / stiffness : 0.0;
  }
};

}  // namespace cdem
