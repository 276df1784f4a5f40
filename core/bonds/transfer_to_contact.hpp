// transfer_to_contact.hpp - the force of released pairs goes to the contacts that follow them.
#pragma once

#include "core/base/device.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Release pairs: give their histories to their faces, see give_history, and the springs of
/// conforming ones the force that their bond points carried, half to either side, so that the
/// change of bookkeeping is no jolt; of a contact that is softer than the bond only what it can
/// hold at the present depth. A point whose spring is free of stress at a gap, because it began
/// loaded or has dilated, gives all that it carried: the contacts are lifted for that. Where a
/// vertex has slid off the face across, the other vertex takes both halves. A point whose vertices
/// have parted, as in a hinge before its last point breaks, carries nothing. Energy that no spring
/// holds is lost to friction. Overlaps that are no hinges keep their force until
/// transfer_released_bonds.
void transfer_to_contact(const Model& model, State& state, const PairSet& pairs, PairState& bonds,
                         const Column<Index>& released);

/// Give the vertices and sides of both faces of pairs the states of the laws of their bond points:
/// each vertex gets the state of its point, or the mean of the points by their weights on it; each
/// side the mean of its ends.
void give_history(const Model& model, State& state, const PairSet& pairs, const PairState& bonds,
                  const Column<Index>& listed);

/// Of overlaps that were released in this step with springs that are free of stress at a gap: let
/// the search find contacts at such a gap, too, with vertices and edges alike.
void await_contacts(const Model& model, State& state);

/// The same of the force of overlaps that were released in this step, once the search
/// has found their contacts. These are not at the bond points: the force of the pair is shared
/// by the depths of the contacts, and no force exceeds the one of its depth; but lifted ones do,
/// alike, until they carry the whole force of the pair.
void transfer_released_bonds(const Model& model, State& state, Queue queue);

}  // namespace cdem
