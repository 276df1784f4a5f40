// velocity_weakening.hpp - Coulomb friction that falls as the joint slips faster.
#pragma once

#include <array>

#include "core/interfaces/brittle.hpp"

namespace cdem {

/// The brittle law with friction that falls with the slip rate v, of broken bonds and contacts:
///
///   tan(phi) = mu_d + (mu_s - mu_d) / (1 + v / v_c)
///
/// v is the rate in the step, elastic part included.
template <class T>
struct VelocityWeakening {
  static constexpr LawText text{.name = "velocity-weakening",
                                .meaning = "Brittle; friction falls with the speed of slip"};
  static constexpr std::array parameters =
      with_more(Brittle<Real>::parameters,
                Parameter{.name = "dynamic_friction_angle",
                          .symbol = "phi_d",
                          .unit = "deg",
                          .meaning = "Friction angle at high speed",
                          .below = 90,
                          .form = Form::tangent,
                          .is_strength = true},
                Parameter{.name = "velocity",
                          .symbol = "v_c",
                          .unit = "m/s",
                          .meaning = "Speed of slip at half of the fall of friction"});
  static constexpr std::array<StateVariable, 0> state{};

  Brittle<T> at_rest;
  T tan_dynamic, velocity;

  template <class Number>
  CDEM_HD static VelocityWeakening read(const Number& number) {
    return {.at_rest = Brittle<T>::read(number), .tan_dynamic = number(5), .velocity = number(6)};
  }
  static const char* contradiction(const Real* parameter) {
    const auto p = VelocityWeakening<Real>::read([&](Index k) { return parameter[k]; });
    if (const char* why = Brittle<Real>::contradiction(parameter)) return why;
    if (!(p.velocity > 0)) return "velocity must be above 0";
    if (p.tan_dynamic > p.at_rest.tan_friction)
      return "dynamic_friction_angle must not be larger than friction_angle, {friction_angle:g}";
    if (p.at_rest.tan_dilation > p.tan_dynamic)
      return "dilation_angle must not be larger than dynamic_friction_angle, "
             "{dynamic_friction_angle:g}";
    return nullptr;
  }
  static Real rise_most(const Real* parameter) { return Brittle<T>::rise_most(parameter); }
  static bool asks_area(const Real*) { return false; }
  static Real friction_fall(const Real* parameter) {
    return (parameter[0] - parameter[5]) / parameter[6];
  }

  CDEM_HD Borne<T> bears(const JointInput<T>& in, const T* state) const {
    return at_rest.bears(in, state);
  }
  CDEM_HD JointAnswer<T> respond(const JointInput<T>& in, T* state) const {
    const T one(1.0), half(0.5);
    Brittle<T> now = at_rest;
    const T fall = at_rest.tan_friction - tan_dynamic;
    const T moving = tan_dynamic + fall / (one + in.slip_rate() / velocity);
    now.tan_friction = select(in.bond > half, at_rest.tan_friction, moving);
    return now.respond(in, state);
  }
};

}  // namespace cdem
