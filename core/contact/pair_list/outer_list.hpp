// outer_list.hpp - outer pair list: possible contacts before the next rebuild.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Vertex -> faces that it may touch; face -> sides of others that its own may cross.
void list_candidates(const Model& model, State& state);

}  // namespace cdem
