// relaxation.hpp - relaxation of a static stage: kinetic or adaptive.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Relaxation method of a static stage, besides the damping of the model.
enum class Relaxation { none, kinetic, adaptive };

/// Kinetic relaxation: stop all motion when the kinetic energy has passed a peak.
void relax_kinetically(const Model& model, State& state);

/// Adaptive relaxation, before a step: scale the masses, or do so again where contacts may have
/// changed. Its step stays as long as it is.
void scale_masses_if_due(const Model& model, State& state);

/// Adaptive relaxation, after a step: damp critically the mode that moves now.
void relax_adaptively(const Model& model, State& state);

}  // namespace cdem
