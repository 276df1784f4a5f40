// mohr_coulomb.hpp - the block law `mohr-coulomb`: perfectly plastic, with a tension cut-off.
#pragma once

#include <array>

#include "core/materials/frictional.hpp"
#include "core/materials/law.hpp"
#include "core/materials/principal_planes.hpp"

namespace cdem {

/// Elastic until a plane of principal stress s1 >= s2 >= s3 (tension positive) is reached:
///
///   shear    N s1 - s3 = 2 c sqrt(N),  flow along (M, 0, -1)
///   tension  s1 = min(T, c / tan phi), flow along the normal
///
/// with N = (1 + sin phi) / (1 - sin phi), and M the same of psi. Corners are met exactly: see
/// docs/theory/materials.md.
template <class T>
struct MohrCoulomb {
  static constexpr LawText text{.name = "mohr-coulomb",
                                .meaning = "Elastic, then Mohr-Coulomb with a tension cut-off"};
  static constexpr std::array parameters{
      frictional[0], frictional[1], frictional[2],
      Parameter{.name = "tensile_strength",
                .symbol = "T",
                .unit = "Pa",
                .meaning = "Largest principal stress; left out, or above it: c / tan(phi)",
                .otherwise = unlimited,
                .is_strength = true}};
  static constexpr std::array state{plastic_state[0], plastic_state[1]};
  static constexpr auto softening = frictional_softening;
  static constexpr bool inelastic = true;
  static const char* contradiction(const Real* parameter) {
    return frictional_contradiction(parameter);
  }

  T cohesion, tan_friction, tan_dilation, tensile_strength;

  template <class Number>
  CDEM_HD static MohrCoulomb read(const Number& number) {
    return {.cohesion = number(0),
            .tan_friction = number(1),
            .tan_dilation = number(2),
            .tensile_strength = number(3)};
  }
  /// Is a stress inside without knowing its principal values? By its mean sm and J2 the largest of
  /// (s1 + s3) / 2 sin(phi) + (s1 - s3) / 2 is sm sin(phi) + sqrt(J2 (1 + sin^2(phi) / 3)); divided
  /// by cos(phi) it needs the tangent only. The largest s1 is sm + 2 sqrt(J2 / 3).
  CDEM_HD Truth<T> surely_elastic(const Sym3<T>& stress) const {
    const Sym3<T> deviator = with_trace(stress, T(0.0));
    const T mean = trace(stress) / T(3.0), j2 = T(0.5) * contract(deviator, deviator);
    const T t = tan_friction;
    const T shear = mean * t + sqrt_of(j2 * (T(1.0) + T(4.0 / 3.0) * (t * t)));
    const T tension = mean + T(2.0) * sqrt_of(j2 / T(3.0));
    return !((shear > cohesion) | (tension > tensile_strength));
  }
  CDEM_HD Sym3<T> flow(const ElasticConstants<T>& elastic, const Sym3<T>& trial, T* state) const {
    const T none(0.0);
    const Sym3<T> still{none, none, none, none, none, none};
    const PrincipalAxes<T> p = principal_axes(trial);
    const PrincipalPlanes<T> planes = yield_planes();
    const T tolerance =
        T(round_off) * (max_of(abs_of(p.value.x), abs_of(p.value.z)) + planes.strength);
    const auto yields = (planes.outside(p.value) > tolerance) & !surely_elastic(trial);
    if (!any_of(yields)) return still;
    const PrincipalFlow<T> flows =
        planes.bring_back(elastic.lambda, elastic.mu, p.value, tolerance);
    state[0] += select(yields, flows.shear, none);
    state[1] += select(yields, flows.tension, none);
    return select(yields, tensor_of(flows, p), still);
  }

 private:
  /// Tolerance of a plane relative to the stress, for rounding at the corners.
  static constexpr Real round_off = 1e-12;
  /// tan(phi) below which the apex of the cone is out of reach.
  static constexpr Real no_apex = 1e-6;

  CDEM_HD PrincipalPlanes<T> yield_planes() const {
    const T one(1.0), root = root_of_n(tan_friction), m = root_of_n(tan_dilation);
    return {.slope = one / (root * root),
            .flow_slope = one / (m * m),
            .strength = T(2.0) * cohesion / root,
            .cut = min_of(tensile_strength, cohesion / max_of(tan_friction, T(no_apex)))};
  }
};

}  // namespace cdem
