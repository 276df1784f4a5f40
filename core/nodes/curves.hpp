// curves.hpp - factors of the load and velocity curves.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Factors of the load and velocity curves for the step that begins now.
void set_loads_and_supports(const Model& model, State& state);

/// The same for the step that began last: after a resume, and after curves have changed.
void find_loads_and_supports(const Model& model, State& state);

}  // namespace cdem
