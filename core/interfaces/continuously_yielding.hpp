// continuously_yielding.hpp - a rough joint that yields from the start and wears. Cundall & Hart
// (1984).
#pragma once

#include <array>

#include "core/interfaces/closure.hpp"
#include "core/interfaces/falling_friction.hpp"
#include "core/interfaces/roughness.hpp"

namespace cdem {

/// A joint without cohesion. Its shear traction nears its strength, which wears:
///
///   tau_m = sigma tan(phi_m),   phi_m = phi + (phi_0 - phi) exp(-s / R)
///   d tau = F k_s du,           F = (1 - tau / tau_m) / (1 - r) <= 1,   ds = (1 - F) |du|
///
/// s is the slip, du the shear displacement in a step, elastic part included, tau the
/// traction along du, and r the value of tau / tau_m at the last reversal, at most 0.75.
/// In a step the solution for constant tau_m is taken; traction across du fades as it is
/// neared. Where strength wears faster than tau follows, tau lies above it (F < 0), but never above
/// sigma tan(phi_0). It dilates by atan(tau / sigma) - phi where that is positive.
template <class T>
struct ContinuouslyYielding {
  static constexpr LawText text{
      .name = "continuously-yielding",
      .meaning = "Rough joint that yields from the start and wears as it slips"};
  static constexpr std::array parameters{
      Parameter{.name = "friction_angle",
                .symbol = "phi",
                .unit = "deg",
                .meaning = "Intrinsic friction angle, of the worn joint",
                .below = 70},
      Parameter{.name = "initial_friction_angle",
                .symbol = "phi_0",
                .unit = "deg",
                .meaning = "Friction angle before the joint has worn",
                .at_most = 70},
      Parameter{.name = "roughness",
                .symbol = "R",
                .unit = "m",
                .meaning = "Slip over which roughness wears to 1/e"},
      strength_factor};
  static constexpr std::array state{
      joint_slip,
      StateVariable{.name = "joint_reversal",
                    .unit = "1",
                    .meaning = "Shear traction over strength at the last reversal of slip"},
      StateVariable{.name = "joint_unloads",
                    .unit = "1",
                    .meaning = "1 if the joint moves against its shear traction"}};

  T worn, initial;  // phi, phi_0  [deg]
  T roughness;      // [m]
  T factor;

  template <class Number>
  CDEM_HD static ContinuouslyYielding read(const Number& number) {
    return {.worn = number(0), .initial = number(1), .roughness = number(2), .factor = number(3)};
  }
  static const char* contradiction(const Real* parameter) {
    if (parameter[1] < parameter[0])
      return "initial_friction_angle must not be below friction_angle, {friction_angle:g}";
    if (!(parameter[2] > 0)) return "roughness must be above 0";
    return nullptr;
  }
  /// phi_m - phi is the largest dilation angle.
  static Real rise_most(const Real* row) {
    return row[2] * tan_of((row[1] - row[0]) * radians_of_degree);
  }
  static bool asks_area(const Real*) { return false; }

  CDEM_HD JointAnswer<T> respond(const JointInput<T>& in, T* state) const {
    const T none(0.0), half(0.5), angle(radians_of_degree);
    const JointStiffness<T>& k = in.stiffness;
    const T elastic = max_of(-k.n * in.opening, none);
    const T pressed = max_of(elastic + in.damping, none);
    const T worn_part = exp_of(-state[0] / roughness);
    const T tangent = tan_of((worn + (initial - worn) * worn_part) * angle) / factor;
    const T most = tan_of(initial * angle) / factor;
    const Sheared first = shear(in, state, pressed, tangent, most);
    const T rise = select(pressed > none, first.slip * first.dilation, none);
    Sheared end = first;
    if (any_of(rise > none)) end = shear(in, state, pressed + k.n * rise, tangent, most);
    state[0] += select(pressed > none, end.slip, none);
    state[1] = end.reversal;
    state[2] = end.unloads;
    const T normal = elastic + k.n * rise;
    const T squared = end.shear1 * end.shear1 + end.shear2 * end.shear2;
    return {.elastic = normal,
            .normal = pressed + k.n * rise,
            .shear1 = end.shear1,
            .shear2 = end.shear2,
            .stored_n = half * k.compliance_n * normal * normal,
            .stored_s = half * k.compliance_s * squared,
            .rise = rise,
            .fracture = none,
            .bond = none,
            .opens = Truth<T>(none > none)};
  }

 private:
  /// Tractions after a step, slip, the tangent of dilation, and the two states of turns.
  struct Sheared {
    T shear1, shear2;  // [Pa]
    T slip;            // [m]
    T dilation, reversal, unloads;
  };
  /// A step under a pressure, with tangents of phi_m and phi_0.
  CDEM_HD Sheared shear(const JointInput<T>& in, const T* state, const T& pressed, const T& tangent,
                        const T& most_tangent) const {
    const T none(0.0), half(0.5), one(1.0), tiny(1e-300);
    const JointStiffness<T>& k = in.stiffness;
    const T strength = pressed * tangent, most = pressed * most_tangent;
    // the direction of tractions in this step, and the old tractions
    const T moved1 = in.dt * in.rate1, moved2 = in.dt * in.rate2;
    const T sheared = sqrt_of(moved1 * moved1 + moved2 * moved2);
    const auto moves = sheared > none;
    const T along1 = -moved1 / max_of(sheared, tiny), along2 = -moved2 / max_of(sheared, tiny);
    const T old1 = k.s * (moved1 - in.shear1), old2 = k.s * (moved2 - in.shear2);
    const T before = old1 * along1 + old2 * along2;
    const auto unloaded = state[2] > half;
    const auto turns = moves & ((unloaded & (before > none)) | ((!unloaded) & (before < none)));
    const T least(-2.0), most_ratio(0.75);  // below -1 where strength has worn
    const T ratio = max_of(min_of(before / max_of(strength, tiny), most_ratio), least);
    const T reversal = select(turns, ratio, state[1]);
    const T scale = max_of(strength * (one - reversal), tiny);
    const T left = select(moves, exp_of(-k.s * sheared / scale), one);
    const T gained = min_of((strength - before) * (one - left), k.s * sheared);
    const T after = before + gained;
    const T new1 = after * along1 + left * (old1 - before * along1),
            new2 = after * along2 + left * (old2 - before * along2);
    const T size = sqrt_of(new1 * new1 + new2 * new2);
    const T keep = select(size < most, one, most / max_of(size, tiny));
    const T against = keep * (new1 * along1 + new2 * along2);
    return {.shear1 = keep * new1,
            .shear2 = keep * new2,
            .slip = select(moves, max_of(sheared - k.compliance_s * gained, none), none),
            .dilation = dilation(keep * size / max_of(pressed, tiny)),
            .reversal = reversal,
            .unloads = select(moves, select(against < none, one, none), state[2])};
  }
  /// tan(atan(F tau / sigma) - phi), divided by F as the strength is.
  CDEM_HD T dilation(const T& ratio) const {
    const T tangent = tan_of(worn * T(radians_of_degree)), now = factor * ratio;
    return max_of((now - tangent) / (T(1.0) + now * tangent), T(0.0)) / factor;
  }
};

}  // namespace cdem
