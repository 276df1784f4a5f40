// ubiquitous_joint.hpp - the block law `ubiquitous-joint`: Mohr-Coulomb rock with a weak plane.
#pragma once

#include <array>

#include "core/materials/law.hpp"

namespace cdem {

/// Rock of another law, every point of which has a plane of less strength, in one direction. With
/// the normal n, which turns with the element, sn = n.S n and tau = |S n - sn n|:
///
///   shear    tau = cj - sn tan(phi_j),  flow along (t, tan(psi_j) n)
///   tension  sn = min(Tj, cj / tan(phi_j)), flow along n
///
/// Rock and plane are brought back alternately; docs/theory/materials.md gives the remainder.
template <class T, template <class> class Rock>
struct JointedRock {
  static constexpr LawText text{.name = "ubiquitous-joint",
                                .meaning = "Mohr-Coulomb rock with a weak plane at every point"};
  static constexpr std::array parameters{
      Rock<T>::parameters[0],
      Rock<T>::parameters[1],
      Rock<T>::parameters[2],
      Rock<T>::parameters[3],
      Parameter{.name = "joint_dip",
                .symbol = "dip",
                .unit = "deg",
                .meaning = "Dip of the weak plane at the start",
                .at_most = 90,
                .form = Form::half_tangent},
      Parameter{.name = "joint_dip_direction",
                .symbol = "dd",
                .unit = "deg",
                .meaning = "Dip direction of the weak plane at the start, clockwise from north (y)",
                .at_most = 360,
                .form = Form::half_tangent},
      Parameter{.name = "joint_cohesion",
                .symbol = "c_j",
                .unit = "Pa",
                .meaning = "Cohesion of the weak plane",
                .is_strength = true},
      Parameter{.name = "joint_friction_angle",
                .symbol = "phi_j",
                .unit = "deg",
                .meaning = "Friction angle of the weak plane",
                .below = 90,
                .form = Form::tangent,
                .is_strength = true},
      Parameter{.name = "joint_dilation_angle",
                .symbol = "psi_j",
                .unit = "deg",
                .meaning = "Dilation angle of the weak plane, at most its friction angle",
                .below = 90,
                .otherwise = 0,
                .form = Form::tangent,
                .is_strength = true},
      Parameter{.name = "joint_tensile_strength",
                .symbol = "T_j",
                .unit = "Pa",
                .meaning = "Tensile strength across the weak plane; left out, or above it: "
                           "c_j / tan(phi_j)",
                .otherwise = unlimited,
                .is_strength = true}};
  static constexpr std::array state{
      Rock<T>::state[0], Rock<T>::state[1],
      StateVariable{.name = "joint_plastic_shear",
                    .unit = "1",
                    .meaning = "Plastic shear angle along the weak plane, summed over increments"},
      StateVariable{
          .name = "joint_plastic_tension",
          .unit = "1",
          .meaning = "Plastic tensile strain across the weak plane, summed over increments"}};
  static constexpr std::array softening{Rock<T>::softening[0],  Rock<T>::softening[1],
                                        Rock<T>::softening[2],  Rock<T>::softening[3],
                                        "joint_cohesion",       "joint_friction_angle",
                                        "joint_dilation_angle", "joint_tensile_strength"};
  static constexpr bool inelastic = true;
  static const char* contradiction(const Real* parameter) {
    if (const char* why = Rock<T>::contradiction(parameter)) return why;
    if (parameter[8] > parameter[7])
      return "joint_dilation_angle must not be larger than joint_friction_angle, "
             "{joint_friction_angle:g} deg";
    return nullptr;
  }
  /// The rock's parameters, then c_j, tan(phi_j), tan(psi_j), T_j and the normal.
  static std::array<Real, 11> prepare(const Real* parameter) {
    std::array<Real, 11> row{};
    for (Index k = 0; k < 4; ++k) row[k] = parameter[k], row[4 + k] = parameter[6 + k];
    const auto [sin_dip, cos_dip] = sine_and_cosine(parameter[4]);
    const auto [sin_direction, cos_direction] = sine_and_cosine(parameter[5]);
    row[8] = sin_dip * sin_direction, row[9] = sin_dip * cos_direction, row[10] = cos_dip;
    return row;
  }

  Rock<T> rock;
  T cohesion, tan_friction, tan_dilation, tensile_strength;  // of the plane
  Vec3<T> normal;

  template <class Number>
  CDEM_HD static JointedRock read(const Number& number) {
    return {.rock = Rock<T>::read(number),
            .cohesion = number(4),
            .tan_friction = number(5),
            .tan_dilation = number(6),
            .tensile_strength = min_of(number(7), number(4) / max_of(number(5), T(no_apex))),
            .normal = {number(8), number(9), number(10)}};
  }
  CDEM_HD Truth<T> surely_elastic(const Sym3<T>& stress) const {
    return rock.surely_elastic(stress) & !traction_of(stress).outside(tensile_strength);
  }
  CDEM_HD Sym3<T> flow(const ElasticConstants<T>& elastic, const Sym3<T>& trial, T* state) const {
    const T none(0.0);
    Sym3<T> all{none, none, none, none, none, none};
    for (int turn = 0; turn < turns; ++turn) {
      const Sym3<T> of_rock = rock.flow(elastic, trial - elastic.stress(all), state);
      all = all + of_rock;
      const Sym3<T> of_plane = slide(elastic, trial - elastic.stress(all), state + 2);
      all = all + of_plane;
      // where one of the two has nothing to do, the other has done all
      if (!any_of((contract(of_rock, of_rock) > none) & (contract(of_plane, of_plane) > none)))
        return all;
    }
    return all;
  }

 private:
  static constexpr int turns = 3;
  /// tan(phi_j) below which the apex is out of reach.
  static constexpr Real no_apex = 1e-6;

  struct SineAndCosine {
    Real sine, cosine;
  };
  static SineAndCosine sine_and_cosine(Real half_tangent) {
    const Real t = half_tangent, square = 1 / (1 + t * t);
    return {2 * t * square, (1 - t * t) * square};
  }
  /// Traction on the plane: across it, along it and the size of the latter.
  struct Traction {
    T across;
    Vec3<T> along;
    T size;
    T excess;  // of the size over the limit of shear
    T tiny;    // by so much it may be outside

    CDEM_HD auto outside(const T& tensile_strength) const {
      return (across > tensile_strength + tiny) | (excess > tiny);
    }
  };
  CDEM_HD Traction traction_of(const Sym3<T>& stress) const {
    const Vec3<T> traction = full(stress) * normal;
    const T across = dot(normal, traction);
    const Vec3<T> along = traction - across * normal;
    const T size = norm(along);
    return {.across = across,
            .along = along,
            .size = size,
            .excess = size + across * tan_friction - cohesion,
            .tiny = T(round_off) * (cohesion + abs_of(across) + size)};
  }
  /// Plastic strain on the plane.
  CDEM_HD Sym3<T> slide(const ElasticConstants<T>& elastic, const Sym3<T>& stress, T* state) const {
    const T none(0.0), one(1.0), stiff = elastic.lambda + elastic.mu + elastic.mu;
    const Traction on = traction_of(stress);
    const auto yields = on.outside(tensile_strength);
    const Sym3<T> still{none, none, none, none, none, none};
    if (!any_of(yields)) return still;
    // shear alone; where that leaves tension: both limits, or where it bears less shear, tension
    const T shear = max_of(on.excess, none) / (elastic.mu + stiff * tan_dilation * tan_friction);
    const auto pulled = on.across - stiff * tan_dilation * shear > tensile_strength;
    const T limit = max_of(cohesion - tensile_strength * tan_friction, none);
    const T angle = select(pulled, max_of(on.size - limit, none) / elastic.mu, shear);
    const T opening = select(pulled, (on.across - tensile_strength) / stiff, tan_dilation * angle);
    state[0] += select(yields, angle, none);
    state[1] += select(yields & pulled, max_of(opening - tan_dilation * angle, none), none);
    const Vec3<T> direction = (one / max_of(on.size, T(1e-300))) * on.along;
    Mat3<T> strain{{none, none, none}, {none, none, none}, {none, none, none}};
    add_outer(strain, angle * direction + opening * normal, normal);
    return select(yields, symmetric(strain), still);
  }
  /// Part of the stress by which the plane may be overstepped.
  static constexpr Real round_off = 1e-12;
};

}  // namespace cdem
