// roughness.hpp - common code of laws of rough joints.
#pragma once

#include "core/base/elementary.hpp"
#include "core/interfaces/law.hpp"

namespace cdem {

/// Target of a factor of safety in a law without a strength parameter.
inline constexpr Parameter strength_factor{
    .name = "strength_factor",
    .symbol = "F",
    .unit = "1",
    .meaning = "Divides the shear strength; a factor of safety multiplies it",
    .at_least = 1e-3,
    .otherwise = 1,
    .is_factor = true};

inline constexpr Real radians_of_degree = 0.017453292519943295;

}  // namespace cdem
