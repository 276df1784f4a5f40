// frictional.hpp - common declarations of block laws with cohesion and friction.
#pragma once

#include <array>

#include "core/base/lanes.hpp"
#include "core/records/law_declaration.hpp"

namespace cdem {

/// Cohesion, friction angle, dilation angle.
inline constexpr std::array frictional{
    Parameter{.name = "cohesion",
              .symbol = "c",
              .unit = "Pa",
              .meaning = "Cohesion",
              .is_strength = true},
    Parameter{.name = "friction_angle",
              .symbol = "phi",
              .unit = "deg",
              .meaning = "Friction angle",
              .below = 90,
              .form = Form::tangent,
              .is_strength = true},
    Parameter{.name = "dilation_angle",
              .symbol = "psi",
              .unit = "deg",
              .meaning = "Dilation angle, at most the friction angle; a factor of safety divides "
                         "its tangent too, so that it stays so",
              .below = 90,
              .otherwise = 0,
              .form = Form::tangent,
              .is_strength = true}};

/// Plastic strain in shear and in tension.
inline constexpr std::array plastic_state{
    StateVariable{.name = "plastic_shear",
                  .unit = "1",
                  .meaning = "Plastic shear strain: sqrt(2/3 s:s) summed over the increments, s "
                             "the deviator of the plastic strain in shear"},
    StateVariable{.name = "plastic_tension",
                  .unit = "1",
                  .meaning = "Plastic strain of the tension cut-off, summed over the increments"}};

/// Parameters that may soften.
inline constexpr std::array frictional_softening{"cohesion", "friction_angle", "dilation_angle",
                                                 "tensile_strength"};

/// Why the first three parameters do not fit each other, or nullptr.
inline const char* frictional_contradiction(const Real* parameter) {
  if (parameter[2] > parameter[1])
    return "dilation_angle must not be larger than friction_angle, {friction_angle:g} deg";
  if (parameter[0] + parameter[1] == 0)
    return "cohesion and friction_angle must not both be 0: such a material carries no shear";
  return nullptr;
}

}  // namespace cdem
