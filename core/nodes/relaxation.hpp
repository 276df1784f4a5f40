// relaxation.hpp - the way to rest of a static stage: kinetic or adaptive.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// The way to rest of a static stage, besides damping that the model has already.
enum class Relaxation { none, kinetic, adaptive };

/// Kinetic relaxation: stop all motion when the kinetic energy has passed a peak.
void relax_kinetically(const Model& model, State& state);

/// Adaptive relaxation: damp critically the mode that moves now.
void relax_adaptively(const Model& model, State& state);

}  // namespace cdem
