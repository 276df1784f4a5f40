// predicted_motion.hpp - prediction and skin of the nodes of exposed faces until the next rebuild.
#pragma once

#include "core/base/math.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// A node of exposed faces as the lists see it: they are too old once it is farther than its skin
/// from its predicted path.
struct PredictedNode {
  Vec3<Real> position;  // when the lists were made  [m]
  Vec3<Real> velocity;  // predicted  [m/s]
  Real skin;            // [m]

  static PredictedNode at(const Real* r) { return {{r[0], r[1], r[2]}, {r[4], r[5], r[6]}, r[7]}; }
  void store(Real* r) const {
    r[0] = position.x, r[1] = position.y, r[2] = position.z, r[3] = skin * skin;
    r[4] = velocity.x, r[5] = velocity.y, r[6] = velocity.z, r[7] = skin;
  }
};

/// Those of the outer list, for host code.
class PredictedNodes {
 public:
  explicit PredictedNodes(const State& s)
      : place_(on_host(s.search.outer.node_predicted)), rows_(on_host(s.search.outer.predicted)) {}
  bool has(Index node) const { return place_[node] >= 0; }
  PredictedNode at(Index node) const {
    return PredictedNode::at(rows_.data() + 8 * std::size_t(place_[node]));
  }

 private:
  OnHost<const Index> place_;
  OnHost<const Real> rows_;
};

/// The inner list looks ahead for this part of the lookahead time, and gives every vertex this part
/// of its skin at most, see pair_list/inner_list.hpp.
inline constexpr Real inner_horizon = 0.06, inner_skin = 0.5;

/// Predict the paths of the nodes of exposed faces, straight on with the rigid motion of their
/// elements (which leaves the elements' vibrations out), and their skins: the deviation that the
/// change of velocity since the last rebuild would make once more.
void predict_motion(const Model& model, State& state);

/// Give nodes their places among the predicted ones.
void place_predicted_nodes(const Model& model, State& state);

/// Has any node left the path that was predicted for it at time `from` [s] by more than its skin?
/// Beyond the lookahead time [s] the lists take every vertex to stand still: sleeping parts need no
/// rebuild.
bool any_exceeds_skin(const State& state, const Column<Real>& predicted, Real from,
                      Real lookahead_time);

}  // namespace cdem
