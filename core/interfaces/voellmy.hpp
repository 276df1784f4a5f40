// voellmy.hpp - friction of a rapid flow on its bed: Coulomb's, and one that grows with the square
// of the speed. Voellmy (1955).
#pragma once

#include <array>

#include "core/interfaces/brittle.hpp"

namespace cdem {

/// The brittle law; broken bonds and contacts that touch slip at
///
///   |t_s| = t_n tan(phi) + rho g v^2 / xi
///
/// v being the slip rate of the step, elastic part included, and g = 9.81 m/s2. The shear spring
/// bears no more than it is strained to, so a joint that slows down only sticks: the turbulent part
/// never drives.
template <class T>
struct Voellmy {
  static constexpr LawText text{
      .name = "voellmy",
      .meaning =
          "Brittle; friction of a flow on its bed, which grows with the square of the speed"};
  static constexpr std::array parameters =
      with_more(Brittle<Real>::parameters,
                Parameter{.name = "turbulence",
                          .symbol = "xi",
                          .unit = "m/s2",
                          .meaning = "Turbulence coefficient: the larger, the faster the flow"},
                Parameter{.name = "flow_density",
                          .symbol = "rho",
                          .unit = "kg/m3",
                          .meaning = "Density of the flow"});
  static constexpr std::array<StateVariable, 0> state{};
  static constexpr Real gravity = 9.81;  // [m/s2]

  Brittle<T> dry;
  T turbulence, density;

  template <class Number>
  CDEM_HD static Voellmy read(const Number& number) {
    return {.dry = Brittle<T>::read(number), .turbulence = number(5), .density = number(6)};
  }
  static const char* contradiction(const Real* parameter) {
    const auto p = Voellmy<Real>::read([&](Index k) { return parameter[k]; });
    if (const char* why = Brittle<Real>::contradiction(parameter)) return why;
    if (!(p.turbulence > 0)) return "turbulence must be above 0";
    if (!(p.density > 0)) return "flow_density must be above 0";
    return nullptr;
  }
  static Real rise_most(const Real* parameter) { return Brittle<T>::rise_most(parameter); }

  CDEM_HD Borne<T> bears(const JointInput<T>& in, const T* state) const {
    return dry.bears(in, state);
  }
  CDEM_HD JointAnswer<T> respond(const JointInput<T>& in, T*) const {
    const T none(0.0), half(0.5);
    const T squared = in.rate1 * in.rate1 + in.rate2 * in.rate2;
    const auto touches = (in.bond < half) & !(in.opening > none);
    const T turbulent = select(touches, T(gravity) * density * squared / turbulence, none);
    return dry.respond_within(in, in.bond, [&](const T& limit) { return limit + turbulent; });
  }
};

}  // namespace cdem
