// drucker_prager.hpp - the block law `drucker-prager`: a round cone with a tension cut-off.
#pragma once

#include <array>

#include "core/materials/frictional.hpp"
#include "core/materials/law.hpp"

namespace cdem {

/// Elastic until sqrt(J2) + q sm = k or the mean stress sm = T; flow along the first with q of the
/// dilation angle, along the second with the normal. The cone meets Mohr-Coulomb's, with sin(phi):
///
///   outer         in triaxial compression: q = 6 sin / (sqrt 3 (3 - sin)), k = q c / tan(phi)
///   inner         in extension:            q = 6 sin / (sqrt 3 (3 + sin))
///   plane-strain  in plane strain, associated: q = 3 tan / sqrt(9 + 12 tan^2)
template <class T>
struct DruckerPrager {
  static constexpr LawText text{
      .name = "drucker-prager",
      .meaning = "Elastic, then the cone of Drucker and Prager with a cut-off of the mean tension"};
  static constexpr std::array parameters{
      frictional[0], frictional[1], frictional[2],
      Parameter{.name = "tensile_strength",
                .symbol = "T",
                .unit = "Pa",
                .meaning = "Largest mean stress; left out, or above it: c / tan(phi)",
                .otherwise = unlimited,
                .is_strength = true},
      Parameter{.name = "match",
                .symbol = "match",
                .unit = "",
                .meaning = "Contact of the cone with Mohr-Coulomb's: triaxial compression "
                           "(outer), extension (inner) or plane strain",
                .otherwise = 0,
                .choices = "outer inner plane-strain"}};
  static constexpr std::array state{plastic_state[0], plastic_state[1]};
  static constexpr auto softening = frictional_softening;
  static constexpr bool inelastic = true;
  static const char* contradiction(const Real* parameter) {
    return frictional_contradiction(parameter);
  }

  T cohesion, tan_friction, tan_dilation, tensile_strength;
  T match;  // 0 outer, 1 inner, 2 plane-strain

  template <class Number>
  CDEM_HD static DruckerPrager read(const Number& number) {
    return {.cohesion = number(0),
            .tan_friction = number(1),
            .tan_dilation = number(2),
            .tensile_strength = number(3),
            .match = number(4)};
  }
  CDEM_HD Sym3<T> flow(const ElasticConstants<T>& elastic, const Sym3<T>& trial, T* state) const {
    const T none(0.0), third(1.0 / 3.0);
    const T slope = slope_of(tan_friction), flow_slope = slope_of(tan_dilation);
    const T strength = cohesion * slope_per_tangent(tan_friction);
    const T apex = strength / max_of(slope, T(no_apex));
    const T cut = min_of(tensile_strength, apex);
    const T mean = third * trace(trial), bulk = elastic.lambda + T(2.0 / 3.0) * elastic.mu;
    const Sym3<T> deviator = with_trace(trial, none);
    const T size = sqrt_of(T(0.5) * contract(deviator, deviator));
    const T tiny = T(round_off) * (size + abs_of(mean) + strength);
    const T excess = size + slope * mean - strength;
    const auto shears = excess > tiny;
    const auto yields = shears | (mean > cut + tiny);
    if (!any_of(yields)) return {none, none, none, none, none, none};
    // the cone alone; past the cut-off: the ring where they meet, or the cut-off alone
    const T d = select(shears, excess / (elastic.mu + bulk * slope * flow_slope), none);
    const T left = size - elastic.mu * d;
    const auto pulled = (mean - bulk * flow_slope * d > cut) | (left < none);
    const T ring = max_of(strength - slope * cut, none);
    const T stays = select(pulled, min_of(size, ring), left);
    const T angle = (size - stays) / elastic.mu;  // of shear, in sqrt(J2)
    const T volume = select(pulled, (mean - cut) / bulk, flow_slope * d);
    state[0] += select(yields, angle / sqrt_of(T(3.0)), none);
    state[1] += select(yields & pulled, max_of(volume - flow_slope * angle, none), none);
    const T scale = T(0.5) * angle / max_of(size, T(1e-300));
    const Sym3<T> still{none, none, none, none, none, none};
    const T normal = third * volume;
    return select(yields, scale * deviator + Sym3<T>{normal, normal, normal, none, none, none},
                  still);
  }

 private:
  static constexpr Real round_off = 1e-12;
  static constexpr Real no_apex = 1e-6;

  /// q / tan(angle) of the cone that matches.
  CDEM_HD T slope_per_tangent(const T& tangent) const {
    const T root = sqrt_of(T(1.0) + tangent * tangent), sine = tangent / root;
    const T sign = select(match < T(0.5), T(-1.0), T(1.0));
    const T triaxial = T(6.0) / (root * sqrt_of(T(3.0)) * (T(3.0) + sign * sine));
    const T plane = T(3.0) / sqrt_of(T(9.0) + T(12.0) * (tangent * tangent));
    return select(match > T(1.5), plane, triaxial);
  }
  CDEM_HD T slope_of(const T& tangent) const { return tangent * slope_per_tangent(tangent); }
};

}  // namespace cdem
