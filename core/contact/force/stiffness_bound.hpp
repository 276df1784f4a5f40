// stiffness_bound.hpp - the stiffness that bonds and contacts put on each node at most.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Sum the stiffness of live bonds and modules on each node. Needs the lists of corners.
void sum_bond_stiffness(const Model& model, State& state);

/// Sum the largest stiffness of contacts of the exposed faces of each node before the next rebuild
/// of the pair list: of each face the stiffest, see list_candidates. Needs the lists of contact
/// corners.
void sum_contact_stiffness(const Model& model, State& state, const Column<Real>& stiffest);

}  // namespace cdem
