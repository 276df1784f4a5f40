// barton_bandis.hpp - a rough joint of rock: strength, dilation and closure from its roughness.
// Barton, Bandis & Bakhtar (1985).
#pragma once

#include <array>

#include "core/interfaces/closure.hpp"
#include "core/interfaces/falling_friction.hpp"
#include "core/interfaces/roughness.hpp"

namespace cdem {

/// A joint without cohesion whose friction angle is that of the flat wall and of its asperities, as
/// far as the slip s has mobilised them:
///
///   |t_s| = sigma tan(phi_mob),    phi_mob = phi_r + J(s / d_peak) i
///   i = JRC_n log10(JCS_n / sigma), from 0 to 70 degrees - phi_r
///
/// J grows to 1 at the peak and falls again; below 0.3 d_peak it is phi_r that is
/// mobilised, in a straight line. A slipping joint rises by tan(J i / 2) of its slip, and a pressed
/// one closes by a hyperbola. Strength is that at the end of a step.
template <class T>
struct BartonBandis {
  static constexpr LawText text{
      .name = "barton-bandis",
      .meaning =
          "Rough joint: friction, dilation and closure from roughness and strength of walls"};
  static constexpr std::array parameters{
      Parameter{.name = "jrc",
                .symbol = "JRC",
                .unit = "1",
                .meaning = "Joint roughness coefficient of a sample of 0.1 m",
                .at_most = 20},
      Parameter{.name = "jcs",
                .symbol = "JCS",
                .unit = "Pa",
                .meaning = "Compressive strength of the joint's walls, of a sample of 0.1 m"},
      Parameter{.name = "residual_friction_angle",
                .symbol = "phi_r",
                .unit = "deg",
                .meaning = "Friction angle of the flat wall",
                .below = 70},
      Parameter{
          .name = "joint_length",
          .symbol = "L",
          .unit = "m",
          .meaning = "Length of the joint between others that cross it: longer ones are smoother",
          .otherwise = 0.1},
      Parameter{.name = "uniaxial_strength",
                .symbol = "s_ci",
                .unit = "Pa",
                .meaning = "Uniaxial compressive strength of the intact rock",
                .like = "jcs"},
      Parameter{.name = "aperture",
                .symbol = "a_j",
                .unit = "m",
                .meaning = "Aperture without stress; left out: JRC / 5 (0.2 s_ci / JCS - 0.1) mm",
                .otherwise = unlimited},
      strength_factor};
  static constexpr std::array state{joint_slip};

  T jrc, jcs;  // of joints of this length  [1], [Pa]
  T flat;      // phi_r  [deg]
  T peak;      // d_peak  [m]
  HyperbolicClosure<T> closure;
  T factor;

  template <class Number>
  CDEM_HD static BartonBandis read(const Number& number) {
    return {.jrc = number(0),
            .jcs = number(1),
            .flat = number(2),
            .peak = number(3),
            .closure = {.initial = number(4), .most = number(5)},
            .factor = number(6)};
  }
  static std::array<Real, 7> prepare(const Real* parameter) {
    const Real jrc = parameter[0], jcs = parameter[1], length = parameter[3];
    const Real in_mm =
        parameter[5] < unlimited ? 1e3 * parameter[5] : jrc / 5 * (0.2 * parameter[4] / jcs - 0.1);
    const Real ratio = 1e-6 * jcs / in_mm;  // [MPa/mm]
    const Real scale = log_of(length / 0.1);
    const Real long_jrc = jrc * exp_of(-0.02 * jrc * scale);
    return {long_jrc,
            jcs * exp_of(-0.03 * jrc * scale),
            parameter[2],
            length / 500 * pow_of(long_jrc / length, Real(0.33)),
            1e9 * (-7.15 + 1.75 * jrc + 0.02 * ratio),
            1e-3 * (-0.296 - 0.0056 * jrc + 2.241 * pow_of(ratio, Real(-0.245))),
            parameter[6]};
  }
  static const char* contradiction(const Real* parameter) {
    if (!(parameter[0] > 0)) return "jrc must be above 0";
    if (!(parameter[1] > 0)) return "jcs must be above 0";
    if (!(parameter[3] > 0)) return "joint_length must be above 0";
    if (!(parameter[5] > 0)) return "aperture must be above 0";
    if (parameter[4] < parameter[1])
      return "uniaxial_strength must not be below jcs, {jcs:g} Pa: walls are no stronger than rock";
    const auto row = prepare(parameter);
    if (!(row[4] > 0))
      return "jrc and jcs give no normal stiffness: -7.15 + 1.75 jrc + 0.02 jcs / aperture must be "
             "above 0, in MPa and mm; take a smaller aperture";
    if (!(row[5] > 0))
      return "jrc and jcs leave no closure: -0.296 - 0.0056 jrc + 2.241 (jcs / aperture)^-0.245 "
             "must "
             "be above 0, in MPa and mm; take a larger aperture";
    return nullptr;
  }
  /// With asperities that carry 70 degrees at any slip; tan(J x) <= J tan(x).
  static Real rise_most(const Real* row) {
    constexpr Real area = 28.2875;  // under J
    return area * row[3] * tan_of(Real(0.5 * (most_angle - row[2]) * radians_of_degree));
  }

  static Real curve_end(const Real* row, Real stiffness_n) {
    return HyperbolicClosure<Real>{.initial = row[4], .most = row[5]}.end(stiffness_n);
  }
  CDEM_HD Closure<T> close(const T& depth, const JointStiffness<T>& k) const {
    return closure.close(depth, k);
  }
  CDEM_HD T depth(const T& pressure, const JointStiffness<T>& k) const {
    return closure.depth(pressure, k);
  }

  CDEM_HD JointAnswer<T> respond(const JointInput<T>& in, T* state) const {
    const T none(0.0), half(0.5), one(1.0);
    const JointStiffness<T>& k = in.stiffness;
    const T depth = max_of(-in.opening, none);
    const T try1 = -k.s * in.shear1, try2 = -k.s * in.shear2;
    const T trial = sqrt_of(try1 * try1 + try2 * try2);
    Closure<T> closed = closure.close(depth, k);
    T pressed = max_of(closed.pressure + in.damping, none);
    Strength now = strength(state[0], pressed);
    const auto slides = trial > now.shear;
    T slip = none, rise = none;
    if (any_of(slides)) {
      for (int round = 0; round < rounds; ++round) {
        const T stiffer = closure.tangent(pressed, k) * now.tan_dilation * now.tan_friction;
        const T slope = max_of(k.s + now.hardening + stiffer, T(1e-3) * k.s);
        slip = max_of(slip + (trial - k.s * slip - now.shear) / slope, none);
        slip = select(slides & (pressed > none), slip, none);
        rise = now.tan_dilation * slip;
        closed = closure.close(depth + rise, k);
        pressed = max_of(closed.pressure + in.damping, none);
        now = strength(state[0] + slip, pressed);
      }
    }
    const auto limited = trial > now.shear;
    const T keep = select(limited, now.shear / trial, one);
    const T shear1 = keep * try1, shear2 = keep * try2;
    state[0] += select(limited & (pressed > none), k.compliance_s * (trial - now.shear), none);
    return {.elastic = closed.pressure,
            .normal = pressed,
            .shear1 = shear1,
            .shear2 = shear2,
            .stored_n = closed.stored,
            .stored_s = half * k.compliance_s * (shear1 * shear1 + shear2 * shear2),
            .rise = rise,
            .fracture = none,
            .bond = none,
            .opens = Truth<T>(none > none)};
  }

 private:
  static constexpr int rounds = 4;
  static constexpr Real most_angle = 70;    // of phi_mob  [deg]
  static constexpr Real least_part = 1e-6;  // of JCS: less pressure has the angle of that
  static constexpr Real log10_of_e = 0.4342944819032518;

  /// Strength under a pressure after a slip.
  struct Strength {
    T shear;                       // [Pa]
    T hardening;                   // its growth with the slip  [Pa/m]
    T tan_friction, tan_dilation;  // of the mobilised angles
  };
  CDEM_HD Strength strength(const T& slip, const T& pressure) const {
    // J at multiples of d_peak, a straight line between; phi_r is mobilised before the first
    constexpr Real place[] = {0.3, 0.6, 1, 2, 4, 10, 25, 100};
    constexpr Real mobilised[] = {0, 0.75, 1, 0.85, 0.70, 0.50, 0.40, 0};
    const T none(0.0), one(1.0), radians(radians_of_degree);
    const T at = slip / peak, start(place[0]);
    const T borne = max_of(pressure, T(least_part) * jcs);
    const T steepness =
        max_of(min_of(jrc * T(log10_of_e) * log_of(jcs / borne), T(most_angle) - flat), none);
    T part = none, growth = none;
    for (int k = 0; k < 7; ++k) {
      const T from(place[k]), length(place[k + 1] - place[k]);
      const T rate((mobilised[k + 1] - mobilised[k]) / (place[k + 1] - place[k]));
      part += rate * min_of(max_of(at - from, none), length);
      growth = select((at > from) & (at < T(place[k + 1])), rate, growth);
    }
    const T angle = flat * min_of(at / start, one) + steepness * part;
    const T rate = select(at < start, flat / start, steepness * growth) / peak;
    const T tangent = tan_of(angle * radians);
    return {.shear = pressure * tangent / factor,
            .hardening = pressure * (one + tangent * tangent) * radians * rate / factor,
            .tan_friction = tangent / factor,
            .tan_dilation = tan_of(T(0.5) * steepness * part * radians) / factor};
  }
};

}  // namespace cdem
