// energy.hpp - the energy ledger.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Energies at the time of the last sampled forces  [J]. Lost and stored energy count positive.
struct Energies {
  Real kinetic = 0, strain = 0, contact = 0;
  Real friction = 0, damping = 0, plastic = 0, fracture = 0, external = 0;
  Real start = 0;  // stored and kinetic energy when the ledger was opened
  Real error = 0;  // what does not close, as a fraction of the largest term so far
};

Energies energies(const Model& model, const State& state);

/// Remember the largest term of the ledger so far, which the closing error is measured against.
void keep_energy_scale(const Model& model, State& state);

/// Open the ledger with the first sampled step.
void open_ledger(const Model& model, State& state);

}  // namespace cdem
