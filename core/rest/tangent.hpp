// tangent.hpp - stiffness of the whole model where it is now: elements, and bonds that bear.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/rest/node_system.hpp"

namespace cdem {

/// Assemble the tangent of all nodes, on the host. Nodes that bonds hold in one place are one
/// point; bodies that no support holds may not move: they have no equilibrium of their own.
NodeSystem tangent_of(const Model& model, State& state);

}  // namespace cdem
