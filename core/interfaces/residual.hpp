// residual.hpp - Coulomb friction whose strength falls at once to a residual value.
#pragma once

#include <array>

#include "core/interfaces/brittle.hpp"
#include "core/interfaces/falling_friction.hpp"

namespace cdem {

/// The brittle law with less friction, and some cohesion, once the bond is broken:
///
///   bonded   |t_s| <= t_n tan(phi)   + c,    -t_n <= T
///   broken   |t_s| <= t_n tan(phi_r) + c_r   where the faces are pressed
///
/// c_r is a strength in pascals, on the area that the faces share: see docs/theory/interfaces.md.
template <class T>
struct Residual {
  static constexpr LawText text{
      .name = "residual",
      .meaning = "Brittle; friction and cohesion fall at once to residual values"};
  static constexpr std::array parameters =
      with_more(Brittle<Real>::parameters, optional_residual_friction_angle, residual_cohesion);
  static constexpr std::array<StateVariable, 0> state{};

  Brittle<T> bonded;
  T tan_residual, cohesion_left;

  template <class Number>
  CDEM_HD static Residual read(const Number& number) {
    return {
        .bonded = Brittle<T>::read(number), .tan_residual = number(5), .cohesion_left = number(6)};
  }
  static const char* contradiction(const Real* parameter) {
    const auto p = Residual<Real>::read([&](Index k) { return parameter[k]; });
    if (const char* why = Brittle<Real>::contradiction(parameter)) return why;
    if (const char* why =
            contradiction_of_residual(p.bonded.tan_friction, p.bonded.tan_dilation, p.tan_residual))
      return why;
    if (p.cohesion_left > p.bonded.cohesion)
      return "residual_cohesion must not be larger than cohesion, {cohesion:g}";
    return nullptr;
  }
  static Real rise_most(const Real* parameter) { return Brittle<T>::rise_most(parameter); }
  static bool asks_area(const Real* parameter) { return parameter[6] > 0; }

  CDEM_HD Borne<T> bears(const JointInput<T>& in, const T* state) const {
    return bonded.bears(in, state);
  }
  /// A broken bond answers as one without tensile strength.
  CDEM_HD JointAnswer<T> respond(const JointInput<T>& in, T*) const {
    const T none(0.0), half(0.5);
    const auto holds = in.bond > half;
    Brittle<T> now = bonded;
    now.tan_friction = select(holds, bonded.tan_friction, tan_residual);
    now.cohesion = select(holds, bonded.cohesion, cohesion_left);
    now.tensile_strength = select(holds, bonded.tensile_strength, none);
    return now.respond_within(in, max_of(in.bond, in.has_area),
                              [](const T& limit) { return limit; });
  }
};

}  // namespace cdem
