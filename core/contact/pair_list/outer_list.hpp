// outer_list.hpp - outer pair list: possible contacts before the next rebuild.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Vertex -> faces that it may touch; face -> sides of others that its own may cross. Returns the
/// stiffest contact that each exposed face may have  [N/m].
Column<Real> list_candidates(const Model& model, State& state);

}  // namespace cdem
