// interface.hpp - the interface law `weakening`: Coulomb friction that weakens as the joint slips.
// One header is a whole law: docs/contributing/adding_a_law.md.
#pragma once

#include <array>

#include "core/interfaces/law.hpp"

namespace cdem {

/// tan(phi) falls in a straight line from its peak to its residual value while the joint slips by
/// `weakening_slip`; cohesion is lost when the bond breaks.
template <class T>
struct Weakening {
  static constexpr LawText text{.name = "weakening",
                                .meaning = "Coulomb friction that weakens with slip"};
  static constexpr std::array parameters{
      Parameter{.name = "friction_angle",
                .symbol = "phi",
                .unit = "deg",
                .meaning = "Peak friction angle",
                .below = 90,
                .form = Form::tangent,
                .is_strength = true},
      Parameter{.name = "residual_angle",
                .symbol = "phi_r",
                .unit = "deg",
                .meaning = "Friction angle after the slip",
                .below = 90,
                .form = Form::tangent,
                .is_strength = true},
      Parameter{.name = "weakening_slip",
                .symbol = "d",
                .unit = "m",
                .meaning = "Slip over which friction weakens"},
      Parameter{.name = "cohesion",
                .symbol = "c",
                .unit = "Pa",
                .meaning = "Cohesion of the intact bond, and its tensile strength",
                .otherwise = 0,
                .is_strength = true,
                .bonds = true}};
  static constexpr std::array state{
      StateVariable{.name = "joint_slip", .unit = "m", .meaning = "Slip of the joint"}};

  T tan_peak, tan_residual, distance, cohesion;

  template <class Number>
  CDEM_HD static Weakening read(const Number& number) {
    return {.tan_peak = number(0),
            .tan_residual = number(1),
            .distance = number(2),
            .cohesion = number(3)};
  }
  static const char* contradiction(const Real* parameter) {
    if (parameter[1] > parameter[0])
      return "residual_angle must not be larger than friction_angle, {friction_angle:g}";
    return nullptr;
  }
  static Real rise_most(const Real*) { return 0; }

  CDEM_HD JointAnswer<T> respond(const JointInput<T>& in, T* state) const {
    const T none(0.0), half(0.5), one(1.0);
    const JointStiffness<T>& k = in.stiffness;
    T elastic = -k.n * in.opening;
    const auto opens = -elastic > in.bond * cohesion;
    elastic = select(opens, none, elastic);
    T normal = select(in.bond > half, elastic, max_of(elastic + in.damping, none));
    normal = select(opens, none, normal);
    const T left = max_of(one - state[0] / distance, none);
    const T tangent = tan_residual + (tan_peak - tan_residual) * left;
    const T try1 = -k.s * in.shear1, try2 = -k.s * in.shear2;
    const T size = sqrt_of(try1 * try1 + try2 * try2);
    const T limit = max_of(normal * tangent + in.bond * cohesion, none);
    const auto slides = size > limit, lets_go = slides & (normal < none);
    elastic = select(lets_go, none, elastic);
    normal = select(lets_go, none, normal);
    const T keep = select(opens | lets_go, none, select(slides, limit / size, one));
    state[0] += select(slides & !(opens | lets_go), k.compliance_s * (size - limit), none);
    const T shear1 = keep * try1, shear2 = keep * try2;
    return {.elastic = elastic,
            .normal = normal,
            .shear1 = shear1,
            .shear2 = shear2,
            .stored_n = half * k.compliance_n * elastic * elastic,
            .stored_s = half * k.compliance_s * (shear1 * shear1 + shear2 * shear2),
            .rise = none,
            .fracture = none,
            .bond = select(opens | slides, none, in.bond),
            .opens = opens};
  }
};

}  // namespace cdem
