// corner_lists.hpp - which rows of forces belong to each node.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Node -> rows of its pairs that are not released, and of its bolts.
void list_corners(const Model& model, State& state);

/// Node -> contact rows of its exposed faces that are not idle.
void list_contact_corners(const Model& model, State& state);

}  // namespace cdem
