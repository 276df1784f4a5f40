// softening.hpp - a joint that loses its strength in a straight line, in any mix of modes.
#pragma once

#include <array>

#include "core/interfaces/brittle.hpp"
#include "core/interfaces/falling_friction.hpp"

namespace cdem {

/// Cohesive joint with fracture energies G1 (opening) and G2 (shear). The damage omega grows from 0
/// to 1 with the inelastic opening w and the slip s of a bond:
///
///   d(omega) = dw / w_u + ds / s_u,    w_u = 2 G1 / T,    s_u = 2 G2 / (c - c_r)
///
///   opening   t_n <= T (1 - omega)                                    tension > 0 here
///   shear     |t_s| <= c (1 - omega) - t_n tan(phi)                   where it is pulled
///             |t_s| <= c_r + (c - c_r) (1 - omega) + |t_n| mu(s)      where it is pressed
///
/// An open joint unloads along the straight line to zero, a slipped one with k_s. Both limits hold
/// at the end of a step: the equations for dw and ds are linear and solved as such, so a step of
/// any size spends the energy that it should. At omega = 1 the bond is broken, and the joint goes
/// on as with slip-weakening friction. Contacts have that friction.
template <class T>
struct Softening {
  static constexpr LawText text{
      .name = "softening",
      .meaning = "Cohesion and tensile strength fall linearly, with fracture energies"};
  static constexpr std::array parameters = with_more(
      Brittle<Real>::parameters, optional_residual_friction_angle,
      [] {
        Parameter p = slip_distance;
        p.otherwise = 0;
        return p;
      }(),
      residual_cohesion,
      Parameter{.name = "fracture_energy_1",
                .symbol = "G1",
                .unit = "J/m2",
                .meaning = "Fracture energy in opening",
                .scatter = 2},
      Parameter{.name = "fracture_energy_2",
                .symbol = "G2",
                .unit = "J/m2",
                .meaning = "Fracture energy in shear, friction apart",
                .scatter = 2});
  static constexpr std::array state{
      StateVariable{.name = "joint_damage",
                    .unit = "1",
                    .meaning = "Damage of a joint, 1 if broken",
                    .loose = 1},
      StateVariable{
          .name = "joint_opening", .unit = "m", .meaning = "Inelastic opening of a bonded joint"},
      joint_slip};

  Brittle<T> peak;
  FallingFriction<T> friction;
  T cohesion_left, energy_1, energy_2;

  template <class Number>
  CDEM_HD static Softening read(const Number& number) {
    return {.peak = Brittle<T>::read(number),
            .friction = {.peak = number(0), .residual = number(5), .distance = number(6)},
            .cohesion_left = number(7),
            .energy_1 = number(8),
            .energy_2 = number(9)};
  }
  static const char* contradiction(const Real* parameter) {
    const auto p = Softening<Real>::read([&](Index k) { return parameter[k]; });
    if (const char* why = Brittle<Real>::contradiction(parameter)) return why;
    if (const char* why =
            contradiction_of_residual(p.friction.peak, p.peak.tan_dilation, p.friction.residual))
      return why;
    if (!(p.peak.cohesion > 0) || !(p.peak.tensile_strength > 0))
      return "softening needs cohesion and tensile_strength above 0; joints without have another "
             "law";
    if (!(p.energy_1 > 0) || !(p.energy_2 > 0))
      return "fracture_energy_1 and fracture_energy_2 must be above 0";
    if (!(p.cohesion_left < p.peak.cohesion))
      return "residual_cohesion must be below cohesion, {cohesion:g}";
    if (p.peak.tensile_strength * p.peak.tan_friction > p.peak.cohesion)
      return "tensile_strength must not be larger than cohesion / tan(friction_angle)";
    if (p.friction.residual < p.friction.peak && !(p.friction.distance > 0))
      return "residual_friction_angle below friction_angle needs slip_distance";
    return nullptr;
  }
  static Real rise_most(const Real* parameter) { return Brittle<T>::rise_most(parameter); }
  static bool asks_area(const Real* parameter) { return parameter[7] > 0; }
  /// Of a softer bond strength would fall by more than the bond unloads: A / k_n + B / k_s must be
  /// below 1 for these A and B, in any mix of modes  [Pa/m].
  static std::array<Real, 2> steepest_fall(const Real* parameter) {
    const auto p = Softening<Real>::read([&](Index k) { return parameter[k]; });
    return {p.peak.tensile_strength * p.per_opening(), p.peak.cohesion * p.per_slip()};
  }

  CDEM_HD Borne<T> bears(const JointInput<T>& in, const T* state) const {
    const T none(0.0);
    Borne<T> answer = peak.bears(in, state);
    answer.holds = answer.holds & !(state[0] > none) & !(-answer.normal > peak.tensile_strength);
    return answer;
  }
  CDEM_HD JointAnswer<T> respond(const JointInput<T>& in, T* state) const {
    const auto holds = in.bond > T(0.5);
    JointAnswer<T> answer{};
    if (any_of(!holds)) answer = slide(in, state[2], holds);
    if (any_of(holds)) {
      T own[3] = {state[0], state[1], state[2]};
      answer = select(holds, soften(in, own), answer);
      for (Index k = 0; k < 3; ++k) state[k] = select(holds, own[k], state[k]);
    }
    return answer;
  }

 private:
  CDEM_HD T per_opening() const { return peak.tensile_strength / (T(2.0) * energy_1); }  // 1 / w_u
  CDEM_HD T per_slip() const {                                                           // 1 / s_u
    return (peak.cohesion - cohesion_left) / (T(2.0) * energy_2);
  }

  /// A broken bond, or a contact.
  CDEM_HD JointAnswer<T> slide(const JointInput<T>& in, T& slip, const Truth<T>& holds) const {
    const T none(0.0);
    Brittle<T> now = peak;
    now.cohesion = cohesion_left;
    now.tensile_strength = none;
    T own = slip;
    const JointAnswer<T> answer =
        respond_falling(now, friction, in, max_of(in.bond, in.has_area), own);
    slip = select(holds, slip, own);
    return answer;
  }

  /// Results of a bond in a step: inelastic opening and slip, and the remaining tractions.
  struct Step {
    T opening, slip;  // [m]
    T pull, shear;    // tension > 0  [Pa]
    T fracture, friction;
  };
  CDEM_HD JointAnswer<T> soften(const JointInput<T>& in, T* state) const {
    const T none(0.0), half(0.5), one(1.0);
    const JointStiffness<T>& k = in.stiffness;
    const T try1 = -k.s * in.shear1, try2 = -k.s * in.shear2;
    const T trial = sqrt_of(try1 * try1 + try2 * try2);
    const auto pulled = in.opening > none;
    Step step = under_pressure(in, trial, state);
    if (any_of(pulled)) {
      const Step other = in_tension(in, trial, state);
      step = {.opening = select(pulled, other.opening, step.opening),
              .slip = select(pulled, other.slip, step.slip),
              .pull = select(pulled, other.pull, step.pull),
              .shear = select(pulled, other.shear, step.shear),
              .fracture = select(pulled, other.fracture, step.fracture),
              .friction = select(pulled, other.friction, step.friction)};
    }
    const T damage = state[0] + (per_opening() * step.opening + per_slip() * step.slip);
    const auto breaks = !(damage < one);
    const T keep = select(trial > step.shear, step.shear / trial, one);
    const T shear1 = keep * try1, shear2 = keep * try2;
    state[0] = min_of(damage, one);
    state[1] += step.opening;
    state[2] += step.slip;
    const T stored_n =
        select(pulled, step.pull * in.opening, k.compliance_n * step.pull * step.pull);
    return {.elastic = -step.pull,
            .normal = -step.pull,
            .shear1 = shear1,
            .shear2 = shear2,
            .stored_n = half * stored_n,
            .stored_s = half * k.compliance_s * (shear1 * shear1 + shear2 * shear2),
            .rise = none,
            .fracture = step.fracture,
            .bond = select(breaks, none, in.bond),
            .opens = Truth<T>(breaks & pulled),
            .friction = step.friction};
  }

  CDEM_HD Step under_pressure(const JointInput<T>& in, const T& trial, const T* state) const {
    const T none(0.0), half(0.5), one(1.0), two(2.0);
    const JointStiffness<T>& k = in.stiffness;
    const T pull = k.n * in.opening, pressed = max_of(-pull, none), left = one - state[0];
    const T cohesive = peak.cohesion - cohesion_left;
    const auto limit_after = [&](const T& slip) {
      return cohesion_left + cohesive * max_of(left - per_slip() * slip, none) +
             pressed * friction.tangent(state[2] + slip);
    };
    const auto fall_after = [&](const T& slip) {
      return select(per_slip() * slip < left, cohesive * per_slip(), none) +
             pressed * friction.fall(state[2] + slip);
    };
    const T last = cohesion_left + pressed * friction.residual;
    const auto slides = trial > limit_after(none);
    const T slip = select(slides, slip_down_to(trial, k.s, last, limit_after, fall_after), none);
    const T damaged = min_of(per_slip() * slip, left);
    const T mean = half * (friction.tangent(state[2]) + friction.tangent(state[2] + slip));
    return {.opening = none,
            .slip = slip,
            .pull = pull,
            .shear = select(slides, max_of(trial - k.s * slip, none), trial),
            .fracture = energy_2 * (two * left - damaged) * damaged,
            .friction = (cohesion_left + pressed * mean) * slip};
  }

  /// None, opening, slip or both: the first that keeps both limits.
  CDEM_HD Step in_tension(const JointInput<T>& in, const T& trial, const T* state) const {
    const T none(0.0), half(0.5), one(1.0);
    const JointStiffness<T>& k = in.stiffness;
    const T left = one - state[0], most = peak.tensile_strength * left;
    const T strength = peak.cohesion - peak.tensile_strength * peak.tan_friction;  // at t_n = T
    const T opening_fall = peak.tensile_strength * per_opening();
    const T secant = select(state[1] > none, most / (most * k.compliance_n + state[1]), k.n);
    const T elastic = secant * in.opening;
    const T excess_n = k.n * (in.opening - state[1]) - most;  // both also below the limits
    const T excess_s = trial - strength * left;
    const T slope_n = k.n - opening_fall, slope_s = k.s - strength * per_slip();
    const auto opens = excess_n > none;

    const T alone = select(opens, excess_n / slope_n, none);
    const T left_alone = max_of(left - per_opening() * alone, none);
    const T pull_alone = select(opens, peak.tensile_strength * left_alone, elastic);
    const auto slips =
        trial > max_of(peak.cohesion * left_alone - peak.tan_friction * pull_alone, none);

    const T from = max_of(peak.cohesion * left - peak.tan_friction * min_of(elastic, most), none);
    const T slip_alone = max_of((trial - from) / (k.s - peak.cohesion * per_slip()), none);
    const T most_then = peak.tensile_strength * max_of(left - per_slip() * slip_alone, none);

    const T crossed = strength * per_opening();
    const T slip_both =
        max_of((slope_n * excess_s + crossed * excess_n) /
                   (slope_n * slope_s - peak.tensile_strength * per_slip() * crossed),
               none);
    const T both = (excess_n + peak.tensile_strength * per_slip() * slip_both) / slope_n;
    const auto both_act = slips & (opens | ((elastic > most_then) & (both > none)));

    Step step;
    step.opening = select(both_act, both, alone);
    step.slip = select(both_act, slip_both, select(slips, slip_alone, none));
    const T left_after =
        max_of(left - (per_opening() * step.opening + per_slip() * step.slip), none);
    const T most_after = peak.tensile_strength * left_after;
    const auto on_limit = opens | both_act;
    step.pull = select(on_limit, most_after, min_of(elastic, most_after));
    step.shear = select(slips, max_of(trial - k.s * step.slip, none), trial);
    step.shear = select(left_after > none, step.shear, none);
    const T opened = state[1] + step.opening;
    const T softer =
        select(opened > none, most_after / (most_after * k.compliance_n + opened), k.n);
    const T spent_n = select(on_limit, most * opened - most_after * state[1],
                             (secant - softer) * in.opening * in.opening);
    step.fracture = half * (spent_n + (from + step.shear) * step.slip);
    step.friction = none;
    return step;
  }
};

}  // namespace cdem
