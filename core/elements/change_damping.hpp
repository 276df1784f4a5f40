// change_damping.hpp - changes of the damping of rock, and of its moduli, between two runs. Host
// code.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Does the rock have Maxwell branches or Rayleigh dashpots?
inline bool damps_rock(const Model& m) { return m.maxwell.any() || m.damping_time > 0; }

/// Moduli of the rock over those of its materials.
inline Real moduli_part(const State& s) { return s.moduli.size() > 0 ? on_host(s.moduli)[0] : 1; }

/// Give the rock other branches and dashpots. Branches in place of branches keep the strains of
/// their springs; those in place of none begin without. What they store less is booked as damping.
void change_damping(Model& model, State& state, const MaxwellBranches& maxwell, Real damping_time);

/// Give the rock moduli of this part of those of its materials; stresses stay. The energy stored at
/// these stresses changes: the ledger goes on from the new one.
void change_moduli(Model& model, State& state, Real part);

}  // namespace cdem
