// surface.hpp - the surface law `foundation`: springs to the ground that can be torn off.
// One header is a whole law: docs/contributing/adding_a_law.md.
#pragma once

#include <array>

#include "core/surface/law.hpp"

namespace cdem {

/// Winkler's foundation: a traction against the displacement of the face, until it is drawn off the
/// ground, along its normal, by more than the ground bears.
template <class T>
struct Foundation {
  static constexpr LawText text{.name = "foundation",
                                .meaning = "Springs to the ground that can break"};
  static constexpr std::array parameters{
      Parameter{
          .name = "modulus", .symbol = "k", .unit = "Pa/m", .meaning = "Traction per displacement"},
      Parameter{.name = "tensile_strength",
                .symbol = "T",
                .unit = "Pa",
                .meaning = "Tensile strength of the ground",
                .otherwise = unlimited}};
  static constexpr std::array state{
      StateVariable{.name = "foundation_lost", .unit = "1", .meaning = "1: broken"}};

  T modulus, tensile_strength;

  template <class Number>
  CDEM_HD static Foundation read(const Number& number) {
    return {.modulus = number(0), .tensile_strength = number(1)};
  }
  static const char* contradiction(const Real*) { return nullptr; }
  /// The stable step follows from it  [Pa/m].
  static Real stiffness(const Real* parameter) { return parameter[0]; }

  CDEM_HD Vec3<T> respond(const SurfacePoint<T>& at, T* state) const {
    const T none(0.0), one(1.0);
    const T pull = -(modulus * dot(at.displacement, at.normal));  // the face looks at the ground
    state[0] = select(pull > tensile_strength, one, state[0]);
    const T holds = select(state[0] > none, none, at.factor * modulus);
    return (-holds) * at.displacement;
  }
};

}  // namespace cdem
