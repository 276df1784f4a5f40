// contact_columns.hpp - state of semi-springs and semi-edges, as kernels see it.
#pragma once

#include "core/base/views.hpp"
#include "core/records/contact_records.hpp"

namespace cdem {

/// State of the semi-springs of exposed faces: slot = 4 * exposed face + vertex.
struct SpringColumns {
  Index* target;         // exposed face in contact, or -1
  Index* target_before;  // the same one step ago
  Real* state;           // rows of ContactState
  Real* friction;        // lost so far  [J]
  Real* dashpot;         // lost in the contact dashpot so far  [J]
  Real* reaction;        // row of 8: force on the mother x y z, stiffness, weights on the target
  Real* rim_action;      // action coefficient of a contact held at a rim, else 0
  Flag* lost;            // 1: a loaded contact was lost because it penetrated too deep
  Flag* unresolved;      // 1: ResolveTargets has still to find the target of this step
};

/// The semi-edge contacts, in the order of their mother faces: first[m] to first[m + 1] are those
/// of exposed face m.
struct EdgeColumns {
  const Index* first;    // [exposed + 1]
  const Index* contact;  // rows of EdgeContact
  Real* state;           // rows of ContactState
  Real* reaction;  // rows of 8: force on the mother x y z, stiffness, place on the mother side
                   // (0..1), place on the target's side (0..1), what friction and dashpot
                   // took in the step  [J]
};

/// The same one step ago.
struct EdgesBefore {
  const Index* first;
  const Index* contact;
  const Real* state;

  /// Place of the contact that a side (4 * exposed face + side) had with an edge, or -1.
  CDEM_HD Index place_of(Index side, Index edge) const {
    for (Index c = first[side / 4]; c < first[side / 4 + 1]; ++c) {
      const EdgeContact held = EdgeContact::at(contact, c);
      if (held.edge == edge && held.mother == side) return c;
    }
    return -1;
  }
};

}  // namespace cdem
