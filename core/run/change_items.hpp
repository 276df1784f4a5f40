// change_items.hpp - items of modules come and go between two runs.
#pragma once

#include "core/contact/force/stiffness_bound.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/nodes/corner_lists.hpp"
#include "core/nodes/sleep.hpp"
#include "core/nodes/time_step.hpp"

namespace cdem {

/// Call change(given, state, which) of a module for the items with flag 1, and renew the lists and
/// the stable step that follow from the items that act.
template <class Module, auto change>
void change_items(const Model& m, State& s, const Flag* which) {
  change(given_of<Module>(m), state_of<Module>(s), which);
  list_corners(m, s);
  sum_bond_stiffness(m, s);
  list_awake_nodes(m, s);
  renew_step(m, s);
}

}  // namespace cdem
