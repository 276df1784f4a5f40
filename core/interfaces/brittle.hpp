// brittle.hpp - Coulomb friction with a bond that breaks in tension or shear. Feng et al. (2014),
// Eq. 14.
#pragma once

#include <array>

#include "core/interfaces/law.hpp"

namespace cdem {

/// The joint is elastic up to its limits, per area:
///
///   opens  when  -t_n > T                    then  t_n = t_s = 0
///   slips  when  |t_s| > t_n tan(phi) + c    then  |t_s| = t_n tan(phi) + c
///   and from the next step on  c = T = 0
///
/// t_n > 0 is compression. Departure from the paper: `>` for its `>=`, and a millionth of c added
/// to T, so that an unloaded joint with T = 0 (or c = 0) keeps its other strength in spite of
/// round-off. And a bond that slips in tension breaks at once: one step later, without
/// strength, it would drop its traction with nothing to show for its energy.
///
/// A joint that slips by ds lifts by tan(psi) ds (dilation): its stress-free gap rises, which
/// presses it harder and so raises the limit. Both are solved for at once.
template <class T>
struct Brittle {
  static constexpr LawText text{
      .name = "brittle",
      .meaning =
          "Coulomb friction with bonds that break in tension or shear: Feng et al. (2014), "
          "Eq. 14"};
  static constexpr std::array parameters{
      Parameter{.name = "friction_angle",
                .symbol = "phi",
                .unit = "deg",
                .meaning = "Friction angle",
                .below = 90,
                .form = Form::tangent,
                .is_strength = true},
      Parameter{.name = "cohesion",
                .symbol = "c",
                .unit = "Pa",
                .meaning = "Cohesion of the intact bond",
                .otherwise = 0,
                .is_strength = true,
                .bonds = true,
                .scatter = 1},
      Parameter{.name = "tensile_strength",
                .symbol = "T",
                .unit = "Pa",
                .meaning = "Tensile strength of the intact bond",
                .otherwise = 0,
                .is_strength = true,
                .bonds = true,
                .scatter = 1},
      Parameter{.name = "dilation_angle",
                .symbol = "psi",
                .unit = "deg",
                .meaning = "Dilation angle: a sliding joint lifts by its tangent times the slip, "
                           "counted in every direction, also in reverse",
                .below = 90,
                .otherwise = 0,
                .form = Form::tangent},
      Parameter{.name = "dilation_slip",
                .symbol = "",
                .unit = "m",
                .meaning = "Slip at which dilation ends",
                .otherwise = 0}};
  static constexpr std::array<StateVariable, 0> state{};

  T tan_friction, cohesion, tensile_strength, tan_dilation, dilation_slip;

  template <class Number>
  CDEM_HD static Brittle read(const Number& number) {
    return {.tan_friction = number(0),
            .cohesion = number(1),
            .tensile_strength = number(2),
            .tan_dilation = number(3),
            .dilation_slip = number(4)};
  }
  static const char* contradiction(const Real* parameter) {
    const auto p = Brittle<Real>::read([&](Index k) { return parameter[k]; });
    // a joint that lifts more than it slips against friction would make energy
    if (p.tan_dilation > p.tan_friction)
      return "dilation_angle must not be larger than friction_angle, {friction_angle:g}";
    if (p.tan_dilation > 0 && !(p.dilation_slip > 0))
      return "dilation_angle needs dilation_slip, the slip after which it dilates no more";
    return nullptr;
  }
  static Real rise_most(const Real* parameter) { return parameter[3] * parameter[4]; }
  static bool asks_area(const Real*) { return false; }

  CDEM_HD Borne<T> bears(const JointInput<T>& in, const T*) const {
    const T one(1.0), half(0.5);
    const JointStiffness<T>& k = in.stiffness;
    const T normal = -k.n * in.opening;
    const T shear1 = -k.s * in.shear1, shear2 = -k.s * in.shear2;
    const T squared = shear1 * shear1 + shear2 * shear2;
    return {.normal = normal,
            .shear1 = shear1,
            .shear2 = shear2,
            .stored = half * (k.compliance_n * normal * normal + k.compliance_s * squared),
            .holds = !(opens(normal, one) | slips(squared, shear_limit(normal, one)))};
  }

  CDEM_HD JointAnswer<T> respond(const JointInput<T>& in, T*) const {
    return respond_within(in, in.bond, [](const T& limit) { return limit; });
  }
  /// The same where `coheres`, 0 or 1, says whether the cohesion counts, and with the limit of
  /// shear that `limit_of` makes of this one.
  template <class Limit>
  CDEM_HD JointAnswer<T> respond_within(const JointInput<T>& in, const T& coheres,
                                        const Limit& limit_of) const {
    const T none(0.0), half(0.5), all(1.0);
    const JointStiffness<T>& k = in.stiffness;
    T elastic = -k.n * in.opening;
    const auto parts = opens(elastic, coheres);
    elastic = select(parts, none, elastic);
    T normal = select(in.bond > half, elastic, max_of(elastic + in.damping, none));
    normal = select(parts, none, normal);
    const T try1 = -k.s * in.shear1, try2 = -k.s * in.shear2;
    const T squared = try1 * try1 + try2 * try2;
    T limit = limit_of(shear_limit(normal, coheres));
    const T tangent = min_of(tan_dilation, tan_friction);
    const auto lifts = (tangent > none) & (normal > none) & slips(squared, limit);
    T rise = none;
    if (any_of(lifts)) {
      const T stiffer = k.s + k.n * tangent * tan_friction;
      const T room = max_of(tan_dilation * dilation_slip - in.risen, none);
      rise = select(lifts, min_of(tangent * (sqrt_of(squared) - limit) / stiffer, room), none);
      normal += k.n * rise;
      elastic += k.n * rise;
      limit = limit_of(shear_limit(normal, coheres));
    }
    const auto slides = slips(squared, limit);
    const auto separates = slides & (normal < none);
    elastic = select(separates, none, elastic);
    normal = select(separates, none, normal);
    const T kept = select(slides, limit / sqrt_of(squared), all);
    const T keep = select(parts | separates, none, kept);
    const T shear1 = keep * try1, shear2 = keep * try2;
    return {.elastic = elastic,
            .normal = normal,
            .shear1 = shear1,
            .shear2 = shear2,
            .stored_n = half * k.compliance_n * elastic * elastic,
            .stored_s = half * k.compliance_s * (shear1 * shear1 + shear2 * shear2),
            .rise = rise,
            .fracture = none,
            .bond = select(parts | slides, none, in.bond),
            .opens = parts};
  }

 private:
  CDEM_HD Truth<T> opens(const T& elastic, const T& bond) const {
    constexpr Real round_off = 1e-6;  // of the cohesion
    return -elastic > bond * (tensile_strength + T(round_off) * cohesion);
  }
  CDEM_HD T shear_limit(const T& normal, const T& bond) const {
    return max_of(normal * tan_friction + bond * cohesion, T(0.0));
  }
  CDEM_HD static Truth<T> slips(const T& squared, const T& limit) {
    return squared > limit * limit;
  }
};

}  // namespace cdem
