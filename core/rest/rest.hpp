// rest.hpp - front door: the equilibrium of elements and bonds, by a solve.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// What a solve has reached.
struct RestFound {
  int rounds = 0, iterations = 0;  // Newton steps, and iterations of all of them together
  Real before = 0, after = 0;      // unbalanced force by applied force
};

/// Stop all motion and move the nodes to where the forces of the moment are in balance: Newton's
/// method on the true forces, with the stiffness of elements and bonds that bear, until the
/// unbalanced force is below `limit` of the applied force or two rounds no longer halve it. Bonds
/// break and contacts begin as in a step. Energies are booked; time does not pass. A round that
/// needs more than `most_iterations` moves nothing, and is the last.
RestFound solve_for_rest(Model& model, State& state, Real limit, int most_iterations = 200);

}  // namespace cdem
