// water.hpp - front door: forces of water pressure on faces and in pores.
#pragma once

#include <vector>

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Forces of water where the nodes are now, which act on them as loads, and their work.
void update_water(const Model& model, State& state, Queue queue);

/// The same at the start, or after blocks were taken out: what they leave dry acts no more. Returns
/// the change of the force on each node, rows of 4 [N]; none where there is no water.
std::vector<Real> change_water(const Model& model, State& state);

}  // namespace cdem
