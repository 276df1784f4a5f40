// roughness.hpp - what laws of rough joints share.
#pragma once

#include "core/base/elementary.hpp"
#include "core/interfaces/law.hpp"

namespace cdem {

/// What a factor of safety multiplies where no parameter is a strength of its own.
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
