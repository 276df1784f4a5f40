// initial_tractions.hpp - bonds and joints of rock that begins under stress. Host code.
#pragma once

#include <vector>

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Where the stress of a bond point is asked for. With the tractions of these places the forces on
/// the vertices of a parallelogram or a triangle are those of a linear stress, whatever the
/// indentation of the bond points.
struct BondPlace {
  Vec3<Real> position;  // [m]
  Index faces[2];
};

/// All bond points: of triangles, quadrilaterals, overlaps; pair by pair.
std::vector<BondPlace> bond_places(const Model& model, State& state);

/// Tractions that the joints could not bear.
struct CutTractions {
  Index count = 0;  // bond points
  Real most = 0;    // largest difference  [Pa]
  Index face = -1;  // where that is
};

/// Give each bond point the traction of a stress S, that on the second face being -S n: the jump at
/// which its spring is free changes, nothing moves. Tractions above the strength of its interface
/// are cut, and a bond that would break is broken.
///
/// `stress` holds xx yy zz xy yz zx of each bond point in the order of `bond_places`  [Pa];
/// `bonded` says for each interface whether it has strength: the points of others begin broken.
CutTractions set_initial_tractions(Model& model, State& state, const Real* stress,
                                   const Flag* bonded);

/// Bond the pairs again of which a side comes in, given by a flag for each node, and none is out:
/// their springs are free where they are. Those whose faces are not at each other stay released.
void bond_again(Model& model, State& state, const Flag* comes, const Flag* bonded);

}  // namespace cdem
