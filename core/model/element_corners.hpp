// element_corners.hpp - the corners of all elements by node.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/records/corners_by_node.hpp"

namespace cdem {

ElementCorners element_corners(const Model& model, const State& state);

/// List the corners of elements at every node, in the order of elements.
void list_element_corners(const Model& model, State& state);

}  // namespace cdem
