// energy.hpp - the energy ledger.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/records/energy_terms.hpp"

namespace cdem {

/// Energies at the time of the last sampled forces  [J]. All terms count positive.
struct Energies {
  Real terms[energy_term_count] = {};
  Real start = 0;  // stored and kinetic energy when the ledger was opened
  Real error = 0;  // closing error, as a fraction of the largest term so far
};

Energies energies(const Model& model, const State& state);

/// Remember the largest term of the ledger so far, which the closing error is measured against.
void keep_energy_scale(const Model& model, State& state);

/// Close the ledger of a relaxation that did not resolve its motion: the energy missing now is
/// booked as damping.
void close_ledger(const Model& model, State& state);

/// Open the ledger with the first sampled step.
void open_ledger(const Model& model, State& state);

}  // namespace cdem
