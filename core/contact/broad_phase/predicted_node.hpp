// predicted_node.hpp - path and skin of a node of exposed faces, in memory.
#pragma once

#include "core/base/math.hpp"

namespace cdem {

/// A node of exposed faces as the lists see it: they are too old once it is farther than its skin
/// from its predicted path.
struct PredictedNode {
  Vec3<Real> position;  // when the lists were made  [m]
  Vec3<Real> velocity;  // predicted  [m/s]
  Real skin;            // [m]

  CDEM_HD static PredictedNode at(const Real* r) {
    return {{r[0], r[1], r[2]}, {r[4], r[5], r[6]}, r[7]};
  }
  CDEM_HD void store(Real* r) const {
    r[0] = position.x, r[1] = position.y, r[2] = position.z, r[3] = skin * skin;
    r[4] = velocity.x, r[5] = velocity.y, r[6] = velocity.z, r[7] = skin;
  }
};

/// Predictions of the outer list.
struct PredictedNodes {
  const Index* place;  // [node] among the predicted ones, or -1
  const Real* rows;    // of PredictedNode

  CDEM_HD bool has(Index node) const { return place[node] >= 0; }
  CDEM_HD PredictedNode at(Index node) const {
    return PredictedNode::at(rows + 8 * std::size_t(place[node]));
  }
};

/// The inner list looks ahead for this part of the lookahead time, and gives every vertex this part
/// of its skin at most, see pair_list/inner_list.hpp.
inline constexpr Real inner_horizon = 0.06, inner_skin = 0.5;

}  // namespace cdem
