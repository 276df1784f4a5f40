// applied_lists.hpp - which rows of applied forces belong to a node. Host code.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// List the rows that each node sums of forces applied by modules, in the order of the rows, and
/// make room for the forces.
void list_applied(const Model& model, State& state);

}  // namespace cdem
