// slip_weakening.hpp - Coulomb friction that falls as the joint slips.
#pragma once

#include <array>

#include "core/interfaces/brittle.hpp"
#include "core/interfaces/falling_friction.hpp"

namespace cdem {

/// The brittle law with friction that falls with the slip s, of bond points and contacts alike:
///
///   tan(phi) = mu_r + (mu_p - mu_r) max(0, 1 - s / Dc)
///
/// The limit of a step is that at its end. Where it falls more steeply than the joint unloads
/// (t_n (mu_p - mu_r) / Dc > k_s) the traction jumps down.
template <class T>
struct SlipWeakening {
  static constexpr LawText text{.name = "slip-weakening",
                                .meaning = "Brittle; friction falls with the slip"};
  static constexpr std::array parameters =
      with_more(Brittle<Real>::parameters, residual_friction_angle, slip_distance);
  static constexpr std::array state{joint_slip};

  Brittle<T> bonded;
  FallingFriction<T> friction;

  template <class Number>
  CDEM_HD static SlipWeakening read(const Number& number) {
    return {.bonded = Brittle<T>::read(number),
            .friction = {.peak = number(0), .residual = number(5), .distance = number(6)}};
  }
  static const char* contradiction(const Real* parameter) {
    const auto p = SlipWeakening<Real>::read([&](Index k) { return parameter[k]; });
    if (const char* why = Brittle<Real>::contradiction(parameter)) return why;
    if (!(p.friction.distance > 0)) return "slip_distance must be above 0";
    return contradiction_of_residual(p.friction.peak, p.bonded.tan_dilation, p.friction.residual);
  }
  static Real rise_most(const Real* parameter) { return Brittle<T>::rise_most(parameter); }
  static bool asks_area(const Real*) { return false; }

  /// A bond that slips breaks: while it is intact it has not slipped.
  CDEM_HD Borne<T> bears(const JointInput<T>& in, const T* state) const {
    return bonded.bears(in, state);
  }
  CDEM_HD JointAnswer<T> respond(const JointInput<T>& in, T* state) const {
    return respond_falling(bonded, friction, in, in.bond, state[0]);
  }
};

}  // namespace cdem
