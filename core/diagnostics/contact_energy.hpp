// contact_energy.hpp - energy stored in contacts, for the terms of the ledger.
#pragma once

#include "core/records/contact_records.hpp"

namespace cdem {

/// Stored in the normal spring of a contact  [J].
struct StoredNormal {
  const Real* state;  // rows of 8 of ContactState
  CDEM_HD Real operator()(One slot) const { return ContactState::at(state, slot.i).energy_n; }
};
/// Stored in its shear spring  [J].
struct StoredShear {
  const Real* state;
  CDEM_HD Real operator()(One slot) const { return ContactState::at(state, slot.i).energy_s; }
};
/// Stored in its resistance to rolling  [J].
struct StoredRolling {
  const Real* rolling;  // rows of 8 of RollingState
  CDEM_HD Real operator()(One slot) const { return RollingState::at(rolling, slot.i).energy; }
};
/// Stored in both springs of the contacts of an exposed face's semi-edges  [J].
struct StoredInEdges {
  const Index* first;  // [exposed + 1]
  const Real* state;
  CDEM_HD Real operator()(One face) const {
    Real sum = 0;
    for (Index c = first[face.i]; c < first[face.i + 1]; ++c) {
      const ContactState edge = ContactState::at(state, c);
      sum += edge.energy_n + edge.energy_s;
    }
    return sum;
  }
};

}  // namespace cdem
