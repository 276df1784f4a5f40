// all_pairs_check.hpp - compare the contacts that a step has found with the contacts of all pairs.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Where the model asks for it, compare the contacts that the step has just found with the contacts
/// of an all-pairs search, and count contacts missed by either.
void check_against_all_pairs(const Model& model, State& state);

}  // namespace cdem
