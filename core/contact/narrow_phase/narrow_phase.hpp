// narrow_phase.hpp - front door: find the targets of semi-springs and semi-edges.
#pragma once

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Target face of every semi-spring, Eq. 6-9.
void find_target_faces(const Model& model, State& state, Queue queue);

/// Target edges of every semi-edge, Eq. 10-12.
void find_target_edges(const Model& model, State& state, Queue queue);

}  // namespace cdem
