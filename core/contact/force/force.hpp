// force.hpp - front door: forces of semi-springs and semi-edges, and their sums by face.
#pragma once

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Force of every contact, Eq. 13-14, and the sum of forces on each exposed face.
void update_contact_forces(const Model& model, State& state, Queue queue);

/// The list of contacts by target has room for more than there are, so that a step need not wait
/// for their number. For whoever looks at it after steps: let it have their length. Waits.
void fit_contacts_by_target(State& state);

}  // namespace cdem
