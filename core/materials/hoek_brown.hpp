// hoek_brown.hpp - the block law `hoek-brown`: the generalised criterion of rock masses.
#pragma once

#include <array>
#include <cmath>

#include "core/base/elementary.hpp"
#include "core/materials/frictional.hpp"
#include "core/materials/law.hpp"
#include "core/materials/principal_planes.hpp"

namespace cdem {

/// Elastic until, compression positive, s1 = s3 + sci (mb s3 / sci + s)^a (Hoek & Brown 2019), or a
/// principal stress is the tensile strength; flow by a dilation angle that is the same at every
/// stress, but at most the friction angle there.
///
/// The return is that to the tangent planes of the curve, which is concave: each lies outside it.
/// The tangent at s3 of the last answer gives the next, always from the same trial stress.
template <class T>
struct HoekBrown {
  static constexpr LawText text{
      .name = "hoek-brown",
      .meaning =
          "Elastic, then the generalised criterion of Hoek and Brown, with a tension cut-off"};
  static constexpr std::array parameters{
      Parameter{.name = "uniaxial_strength",
                .symbol = "s_ci",
                .unit = "Pa",
                .meaning = "Uniaxial compressive strength of the intact rock",
                .at_least = 1},
      Parameter{
          .name = "gsi",
          .symbol = "GSI",
          .unit = "1",
          .meaning = "Geological strength index; with mi and disturbance it gives mb, s and a",
          .at_least = 5,
          .at_most = 100,
          .otherwise = unlimited},
      Parameter{.name = "mi",
                .symbol = "m_i",
                .unit = "1",
                .meaning = "m of the intact rock",
                .at_least = 1,
                .at_most = 100,
                .otherwise = unlimited},
      Parameter{.name = "disturbance",
                .symbol = "D",
                .unit = "1",
                .meaning = "Disturbance by blasting and relief, with gsi",
                .at_most = 1,
                .otherwise = 0},
      Parameter{.name = "mb",
                .symbol = "m_b",
                .unit = "1",
                .meaning = "m of the rock mass; mb, s and a instead of gsi and mi",
                .at_least = 1e-3,
                .otherwise = unlimited},
      Parameter{.name = "s",
                .symbol = "s",
                .unit = "1",
                .meaning = "s of the rock mass",
                .at_least = 1e-8,
                .at_most = 1,
                .otherwise = unlimited},
      Parameter{.name = "a",
                .symbol = "a",
                .unit = "1",
                .meaning = "Exponent of the rock mass",
                .at_least = 0.5,
                .at_most = 0.666,
                .otherwise = unlimited},
      Parameter{.name = "dilation_angle",
                .symbol = "psi",
                .unit = "deg",
                .meaning = "Dilation angle, the same at every stress",
                .below = 60,
                .otherwise = 0,
                .form = Form::tangent},
      Parameter{.name = "tensile_strength",
                .symbol = "T",
                .unit = "Pa",
                .meaning = "Largest principal stress; left out, or above it: s s_ci / m_b",
                .otherwise = unlimited,
                .is_strength = true},
      Parameter{.name = "strength_factor",
                .symbol = "F",
                .unit = "1",
                .meaning =
                    "Divides cohesion and friction of every tangent to the curve; a factor of "
                    "safety multiplies it",
                .at_least = 1e-3,
                .otherwise = 1,
                .is_factor = true}};
  static constexpr std::array state{plastic_state[0], plastic_state[1]};
  static constexpr bool inelastic = true;
  static const char* contradiction(const Real* parameter) {
    const auto given = [&](Index k) { return std::isfinite(parameter[k]); };
    const int by_index = given(1) + given(2), by_numbers = given(4) + given(5) + given(6);
    if (by_index == 2 && by_numbers == 0) return nullptr;
    if (by_index == 0 && by_numbers == 3 && parameter[3] == 0) return nullptr;
    return "give gsi and mi (and disturbance), or mb, s and a: one of the two sets, and all of it";
  }
  /// s_ci, m_b, s, a, tan(psi), T, F.
  static std::array<Real, 7> prepare(const Real* parameter) {
    const Real gsi = parameter[1], d = parameter[3];
    Real m = parameter[4], s = parameter[5], a = parameter[6];
    if (std::isfinite(gsi)) {
      m = parameter[2] * exp_of((gsi - 100) / (28 - 14 * d));
      s = exp_of((gsi - 100) / (9 - 3 * d));
      a = 0.5 + (exp_of(-gsi / 15) - exp_of(Real(-20.0 / 3))) / 6;
    }
    return {parameter[0], m, s, a, parameter[7], min_of(parameter[8], s * parameter[0] / m),
            parameter[9]};
  }

  T uniaxial_strength, m, s, a, tan_dilation, tensile_strength, factor;

  template <class Number>
  CDEM_HD static HoekBrown read(const Number& number) {
    return {.uniaxial_strength = number(0),
            .m = number(1),
            .s = number(2),
            .a = number(3),
            .tan_dilation = number(4),
            .tensile_strength = number(5),
            .factor = number(6)};
  }
  /// Is a stress inside without its principal values? s1 <= sm + 2 sqrt(J2 / 3) and s1 - s3 <=
  /// 2 sqrt(J2); and x^a >= min(x^(1/2), x^(2/3)).
  CDEM_HD Truth<T> surely_elastic(const Sym3<T>& stress) const {
    const T one(1.0);
    const Sym3<T> deviator = with_trace(stress, T(0.0));
    const T mean = trace(stress) / T(3.0), j2 = T(0.5) * contract(deviator, deviator);
    const T largest = mean + T(2.0) * sqrt_of(j2 / T(3.0));
    const T x = s - m * largest / uniaxial_strength, y = T(2.0) * sqrt_of(j2) / uniaxial_strength;
    const auto shear = (y * y < x) & (y * y * y < x * x) & (x > T(0.0));
    return shear & (largest < tensile_strength) & (factor < one + T(round_off));
  }
  CDEM_HD Sym3<T> flow(const ElasticConstants<T>& elastic, const Sym3<T>& trial, T* state) const {
    const T none(0.0);
    const Sym3<T> still{none, none, none, none, none, none};
    const PrincipalAxes<T> p = principal_axes(trial);
    const T tolerance =
        T(round_off) * (max_of(abs_of(p.value.x), abs_of(p.value.z)) + uniaxial_strength);
    PrincipalPlanes<T> planes = tangent_at(p.value.x);
    const auto yields = planes.outside(p.value) > tolerance;
    if (!any_of(yields)) return still;
    PrincipalFlow<T> flows = planes.bring_back(elastic.lambda, elastic.mu, p.value, tolerance);
    for (int pass = 1; pass < passes; ++pass) {
      const T* e = flows.strain;
      const T largest =
          p.value.x - elastic.lambda * (e[0] + e[1] + e[2]) - (elastic.mu + elastic.mu) * e[0];
      planes = tangent_at(largest);
      flows = planes.bring_back(elastic.lambda, elastic.mu, p.value, tolerance);
    }
    state[0] += select(yields, flows.shear, none);
    state[1] += select(yields, flows.tension, none);
    return select(yields, tensor_of(flows, p), still);
  }

 private:
  static constexpr Real round_off = 1e-12;
  static constexpr int passes = 6;
  /// Part of s below which the curve is not followed towards the apex, where it is steep.
  static constexpr Real steepest = 1e-4;

  /// The tangent plane where the largest principal stress is this, tension positive, and the
  /// cut-off.
  CDEM_HD PrincipalPlanes<T> tangent_at(const T& largest) const {
    const T one(1.0), two(2.0);
    const T x = max_of(s - m * largest / uniaxial_strength, T(steepest) * s);
    const T power = pow_of(x, a - one);
    const T n = one + a * m * power, s3 = (x - s) * uniaxial_strength / m;
    const T strength = uniaxial_strength * x * power - (n - one) * s3;  // s1 of the plane at s3 = 0
    // cohesion and tangent of friction of the plane, reduced
    const T root = sqrt_of(n), tan_friction = (n - one) / (two * root) / factor;
    const T cohesion = strength / (two * root) / factor;
    const T new_root = root_of_n(tan_friction);
    const T flow_root = min_of(root_of_n(tan_dilation), new_root);  // more would make energy
    return {.slope = one / (new_root * new_root),
            .flow_slope = one / (flow_root * flow_root),
            .strength = two * cohesion / new_root,
            .cut = min_of(tensile_strength, cohesion / tan_friction)};
  }
};

}  // namespace cdem
